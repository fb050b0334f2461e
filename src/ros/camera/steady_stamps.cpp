#include "steady_stamps.hpp"

#include <algorithm>

namespace robot_vision
{

ros::Time SteadyStamps::next(std::int64_t monotonic_ns, const ros::Time& time)
{
  // Another device's first frame may be older than the last one's last.
  const std::int64_t least = std::max<std::int64_t>(1, (monotonic_ns - last_monotonic_ns_) / 2);
  last_ = last_.isZero() ? time : std::max(time, last_ + ros::Duration().fromNSec(least));
  last_monotonic_ns_ = monotonic_ns;
  return last_;
}

}  // namespace robot_vision
