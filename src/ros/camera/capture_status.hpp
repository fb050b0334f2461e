#pragma once

#include <string>

#include "ros/images/frame_statistics.hpp"

namespace robot_vision
{

/// What /diagnostics say of a capture. After a loss it is an error until a frame has come, if one is wanted: a device
/// that can be opened need not stream. For one thread.
class CaptureStatus
{
public:
  explicit CaptureStatus(FrameStatistics& statistics) : statistics_(statistics) {}

  /// True if the description is another than before.
  bool opened(const std::string& description);
  void lost(const std::string& why);
  /// A frame has come; true if it is the first since a loss.
  bool streaming();
  /// Nobody wants frames of the source, which is there; true if it was lost before.
  bool idle();
  void stopped();
  void ended(const std::string& error);

private:
  FrameStatistics& statistics_;
  std::string description_;
  bool lost_ = false;  // since the last frame
};

}  // namespace robot_vision
