#include "monotonic_clock.hpp"

#include <limits>

#include "robot_vision/common/monotonic.hpp"

namespace robot_vision
{
ros::Time toRosTime(std::int64_t monotonic_ns)
{
  if (monotonic_ns == 0 || ros::Time::isSimTime()) return ros::Time::now();
  // The thread may lose the processor between two readings; of three tries the tightest counts.
  std::int64_t tightest = std::numeric_limits<std::int64_t>::max();
  ros::Time stamp;
  for (int i = 0; i < 3; ++i)
  {
    const std::int64_t before = monotonicNow();
    const ros::Time now = ros::Time::now();
    const std::int64_t after = monotonicNow();
    if (after - before >= tightest) continue;
    tightest = after - before;
    stamp = now - ros::Duration().fromNSec(before + tightest / 2 - monotonic_ns);
  }
  return stamp;
}

}  // namespace robot_vision
