#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// Told by a CaptureLoop what happens, in its thread; only the first onOpened may come from its maker's.
class CaptureListener
{
public:
  virtual ~CaptureListener() = default;
  virtual void onOpened(const FrameSource& source) = 0;
  /// May give `frame.image` memory for the source to fill.
  virtual void prepare(Frame& frame) = 0;
  virtual void onFrame(const Frame& frame) = 0;
  /// A damaged frame, or the damaged end of a looping video; the next may be good.
  virtual void onRefused(const std::string& why) = 0;
  /// There is no source now; it is tried again, soon at first and every second in the end.
  virtual void onUnavailable(const std::string& why) = 0;
  virtual void onIdle() = 0;
  /// The source has ended; `error` is empty if that is as it should be.
  virtual void onEnd(const std::string& error) = 0;
};

/// Seconds without a frame until a live source of this period counts as out of order; drivers may tell nonsense.
double frameTimeoutFor(double period, double timeout);

/// What is asked of a CaptureLoop.
enum class Demand
{
  kStopped,  // a live source is left alone, and not even looked for
  kIdle,     // nobody wants frames, but the absence of a live source is told
  kFrames,
};

/// Reads a source in a thread of its own, at its pace, while frames are wanted. A live source is closed while they are
/// not, so that others can have the device and no old frames wait in it; a file goes on where it was.
class CaptureLoop
{
public:
  using Open = std::function<std::unique_ptr<FrameSource>(const CaptureParams&)>;

  /// Throws std::invalid_argument for a parameter out of range and SourceError for a wrong file. A device or URL is
  /// opened by the loop's thread, again and again until it is there.
  CaptureLoop(const CaptureParams& params, CaptureListener& listener, Open opener = openSource);
  ~CaptureLoop();
  CaptureLoop(const CaptureLoop&) = delete;
  CaptureLoop& operator=(const CaptureLoop&) = delete;

  /// kStopped before the first call.
  void setDemand(Demand demand);
  /// The rate in Hz to read at, 0: the source's own; and whether to begin again at its end.
  void setPace(double framerate, bool loop);

private:
  using Clock = std::chrono::steady_clock;

  /// What the node's callbacks ask of the loop.
  struct CaptureRequest
  {
    Demand demand = Demand::kStopped;
    bool stop = false;
    bool new_pace = false;
    double framerate = 0.0;
    bool loop = false;
  };

  void run();
  CaptureRequest takeRequest();
  void follow(const CaptureRequest& request);
  void idle(Demand demand);
  void retry();
  void open();
  void readFrame(const CaptureRequest& request);
  void pace(double framerate);
  void end(const std::string& error, bool loop);
  void finish(const std::string& error);
  void lose(const std::string& why);
  std::string stall(const std::string& what);
  bool waitUntil(Clock::time_point time);

  CaptureParams params_;
  CaptureListener& listener_;
  Open open_;
  bool live_;  // what is not there, or fails, may be there again: it is never given up
  std::unique_ptr<FrameSource> source_;
  bool available_ = false;  // the last try to open the source, or to read it, went well
  bool ended_ = false;
  bool read_since_rewind_ = false;  // else looping would spin on an empty source
  Clock::time_point next_frame_;
  Clock::time_point last_frame_;         // or when the source was opened
  Clock::time_point last_sign_;          // of life: a frame, even if it makes no picture yet
  std::string device_file_;              // of a source that is a device
  std::optional<double> frame_timeout_;  // s; asked of the source once it is late, for its exposure may have been set
  Clock::time_point next_try_;
  Clock::duration retry_{};  // from the last loss to the next try
  std::string loss_;         // the last error since the last frame

  std::mutex mutex_;  // guards request_
  std::condition_variable changed_;
  CaptureRequest request_;
  std::thread thread_;
};

}  // namespace robot_vision
