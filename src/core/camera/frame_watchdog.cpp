#include "frame_watchdog.hpp"

#include <algorithm>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kTimeoutPeriods = 3.0;      // of a camera so slow that this is longer than its timeout
constexpr double kMaxFrameTimeout = 30.0;    // s, unless the timeout itself is longer
constexpr double kMaxKeyframePeriod = 30.0;  // s, in a stream

double secondsSince(std::chrono::steady_clock::time_point time)
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - time).count();
}

}  // namespace

double frameTimeoutFor(double period, double timeout)
{
  return std::max(timeout, std::min(kTimeoutPeriods * period, kMaxFrameTimeout));
}

void FrameWatchdog::onFrame()
{
  last_frame_ = last_data_ = Clock::now();
  frame_timeout_.reset();
}

std::string FrameWatchdog::stall(const FrameSource& source, const std::string& missing)
{
  const double without_image = secondsSince(last_frame_);
  if (source.rate() != 0.0 || without_image <= timeout_) return "";
  const auto reason = [&source](const std::string& what, double seconds)
  { return source.description() + ": " + what + " for " + toText(seconds) + " s"; };
  if (!frame_timeout_) frame_timeout_ = frameTimeoutFor(source.period(), timeout_);
  if (secondsSince(last_data_) > *frame_timeout_) return reason(missing, *frame_timeout_);
  const double keyframe_timeout = std::max(*frame_timeout_, kMaxKeyframePeriod);
  return without_image > keyframe_timeout ? reason("no keyframe", keyframe_timeout) : "";
}

}  // namespace robot_vision
