#pragma once

#include <ros/time.h>

#include <cstdint>

namespace robot_vision
{

/// The ROS time of a time on CLOCK_MONOTONIC (ns); of 0, and while ROS time is simulated and knows nothing of that
/// clock, the ROS time of now.
ros::Time toRosTime(std::int64_t monotonic_ns);

}  // namespace robot_vision
