#include "steady_stamps.hpp"

#include <algorithm>
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

ros::Time SteadyStamps::next(std::int64_t monotonic_ns, const ros::Time& time)
{
  // The first frame of another device may be older than the last frame of the one before.
  const std::int64_t min_step_ns = std::max<std::int64_t>(1, (monotonic_ns - last_monotonic_ns_) / 2);
  last_ = last_.isZero() ? time : std::max(time, last_ + ros::Duration().fromNSec(min_step_ns));
  last_monotonic_ns_ = monotonic_ns;
  return last_;
}

}  // namespace robot_vision
