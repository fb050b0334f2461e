#pragma once

#include <functional>
#include <memory>
#include <string>

#include "robot_vision/camera/frame_source.hpp"
#include "robot_vision/camera/open_source.hpp"

namespace robot_vision
{

/// Is told by a CaptureLoop what happens, in the thread of the loop. Only the first onOpened may come from the thread
/// that makes the loop.
class CaptureListener
{
public:
  virtual ~CaptureListener() = default;
  /// The source was opened, or has taken another rate.
  virtual void onOpened(const FrameSource& source) = 0;
  /// The images that the next frame is to have.
  virtual WantedViews wantedViews() { return {}; }
  /// May give the images of `frame` memory for the source to fill.
  virtual void prepare(Frame& frame) = 0;
  virtual void onFrame(const Frame& frame) = 0;
  /// A frame, or the end of a looping video, is damaged. The next frame may be good.
  virtual void onRefused(const std::string& reason) = 0;
  /// There is no source now. The loop tries to open it again, soon at first and every second in the end.
  virtual void onUnavailable(const std::string& reason) = 0;
  /// The loop waits, as no frames are wanted. Unless it is stopped, the source is there.
  virtual void onIdle() = 0;
  /// The source has ended, because of `error` unless that is empty.
  virtual void onEnd(const std::string& error) = 0;
};

/// What a CaptureLoop is to do.
enum class Demand
{
  kStopped,  // leave a live source alone, and do not even look for it
  kIdle,     // read no frames, but tell if a live source is not there
  kFrames,
};

/// Reads a source in a thread of its own, at the source's pace, while frames are wanted. Otherwise a live source is
/// closed, so that others can use the device and no old frames wait in it; a file goes on where it was.
class CaptureLoop
{
public:
  using Open = std::function<std::unique_ptr<FrameSource>(const CaptureParams&)>;

  /// Throws std::invalid_argument for a parameter out of range and SourceError for a wrong file. A device or URL is
  /// opened by the loop's thread, which tries until it succeeds.
  CaptureLoop(const CaptureParams& params, CaptureListener& listener, const Open& open = openSource);
  ~CaptureLoop();

  /// kStopped before the first call.
  void setDemand(Demand demand);
  /// The rate in Hz to read at, 0 for the source's own, and whether to begin again at the end of the source.
  void setPace(double framerate, bool loop);

private:
  class Reader;
  std::unique_ptr<Reader> reader_;
};

}  // namespace robot_vision
