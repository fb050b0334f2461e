#pragma once

#include <ros/time.h>

#include <cstdint>

namespace robot_vision
{

/// Converts a time on CLOCK_MONOTONIC (ns) to ROS time. The result is the present ROS time for 0, and while ROS time is
/// simulated and thus independent of that clock.
ros::Time toRosTime(std::int64_t monotonic_ns);

}  // namespace robot_vision
