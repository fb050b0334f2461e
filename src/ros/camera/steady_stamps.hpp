#pragma once

#include <ros/time.h>

#include <cstdint>

namespace robot_vision
{

/// Keeps the stamps of a camera's frames in order when the system's clock is set back: until it has caught up, they run
/// at half its speed. (Later frames with earlier stamps would be taken for older ones, and tf forgets all it knows.)
class SteadyStamps
{
public:
  /// The stamp of the next frame, captured at `monotonic_ns` on CLOCK_MONOTONIC, now that this is the ROS time `time`.
  ros::Time next(std::int64_t monotonic_ns, const ros::Time& time);

private:
  std::int64_t last_monotonic_ns_ = 0;
  ros::Time last_;
};

}  // namespace robot_vision
