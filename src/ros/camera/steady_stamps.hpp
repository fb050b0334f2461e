#pragma once

#include <ros/time.h>

#include <cstdint>

namespace robot_vision
{

/// Converts a time on CLOCK_MONOTONIC (ns) to ROS time. The result is the present ROS time for 0, and while ROS time is
/// simulated and thus independent of that clock.
ros::Time toRosTime(std::int64_t monotonic_ns);

/// Keeps the stamps of a camera's frames in order when the system's clock is set back: the stamps then run at half
/// speed until the clock has caught up. Stamps that go back would make later frames look older, and would clear tf's
/// buffers.
class SteadyStamps
{
public:
  /// The stamp of the next frame, which was captured at `monotonic_ns` on CLOCK_MONOTONIC; `time` is the same in ROS
  /// time.
  ros::Time next(std::int64_t monotonic_ns, const ros::Time& time);

private:
  std::int64_t last_monotonic_ns_ = 0;
  ros::Time last_;
};

}  // namespace robot_vision
