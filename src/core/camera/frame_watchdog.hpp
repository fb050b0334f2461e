#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// Seconds without a frame after which a live source of this period counts as out of order. The period is not trusted
/// beyond half a minute, as drivers may tell nonsense.
double frameTimeoutFor(double period, double timeout);

/// Notices when a live source gives no images any more.
class FrameWatchdog
{
public:
  /// `timeout` is CaptureParams::timeout.
  explicit FrameWatchdog(double timeout) : timeout_(timeout) {}

  /// The source has been opened, or has given a good frame.
  void onFrame();

  /// The source has given something that makes no image yet.
  void onData() { last_data_ = Clock::now(); }

  /// Why the source counts as out of order, as `missing` has not come for too long; empty while it does not. A source
  /// with a rate of its own never does.
  std::string stall(const FrameSource& source, const std::string& missing);

private:
  using Clock = std::chrono::steady_clock;

  double timeout_;  // s
  Clock::time_point last_frame_;
  Clock::time_point last_data_;
  std::optional<double> frame_timeout_;  // s; the source is asked for it when a frame is late, as exposures change
};

}  // namespace robot_vision
