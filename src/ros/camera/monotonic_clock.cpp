#include "monotonic_clock.hpp"

#include <limits>

#include "robot_vision/common/monotonic.hpp"

namespace robot_vision
{
ros::Time toRosTime(std::int64_t monotonic_ns)
{
  if (monotonic_ns == 0 || ros::Time::isSimTime()) return ros::Time::now();
  // The thread may lose the processor between the readings, so the fastest of three tries counts.
  std::int64_t shortest = std::numeric_limits<std::int64_t>::max();
  ros::Time stamp;
  for (int i = 0; i < 3; ++i)
  {
    const std::int64_t before = monotonicNow();
    const ros::Time now = ros::Time::now();
    const std::int64_t after = monotonicNow();
    if (after - before >= shortest) continue;
    shortest = after - before;
    stamp = now - ros::Duration().fromNSec(before + shortest / 2 - monotonic_ns);
  }
  return stamp;
}

}  // namespace robot_vision
