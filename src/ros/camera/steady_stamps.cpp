#include "steady_stamps.hpp"

#include <algorithm>

namespace robot_vision
{

ros::Time SteadyStamps::next(std::int64_t monotonic_ns, const ros::Time& time)
{
  // The first frame of another device may be older than the last frame of the one before.
  const std::int64_t min_step_ns = std::max<std::int64_t>(1, (monotonic_ns - last_monotonic_ns_) / 2);
  last_ = last_.isZero() ? time : std::max(time, last_ + ros::Duration().fromNSec(min_step_ns));
  last_monotonic_ns_ = monotonic_ns;
  return last_;
}

}  // namespace robot_vision
