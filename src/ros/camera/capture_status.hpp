#pragma once

#include <string>

#include "ros/images/frame_statistics.hpp"

namespace robot_vision
{

/// The state of a capture on /diagnostics. After a loss of the source the state is an error until a frame arrives, if
/// frames are wanted, because a device that can be opened need not stream. To be used by one thread.
class CaptureStatus
{
public:
  explicit CaptureStatus(FrameStatistics& statistics) : statistics_(statistics) {}

  /// The source is open; returns true if its description has changed.
  bool opened(const std::string& description);
  void lost(const std::string& reason);
  /// A frame has arrived; returns true if it is the first one since a loss.
  bool streaming();
  /// The source is available, but nobody wants its frames; returns true if it was lost before.
  bool idle();
  void stopped();
  void ended(const std::string& error);

private:
  FrameStatistics& statistics_;
  std::string description_;
  bool lost_ = false;  // since the last frame
};

}  // namespace robot_vision
