#include "robot_vision/camera/capture_loop.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "frame_watchdog.hpp"
#include "v4l2_device.hpp"

namespace robot_vision
{
namespace
{

using Clock = std::chrono::steady_clock;

// A driver works again soon after an error, but a device that was unplugged need not be looked for all the time.
constexpr std::chrono::milliseconds kMinRetryDelay{100};
constexpr std::chrono::milliseconds kMaxRetryDelay{1000};
constexpr std::chrono::seconds kProbePeriod{1};  // between looks whether a device that nobody uses is still there
constexpr double kMaxPeriod = 1e6;               // s, far from the clock's limits

/// What is asked of a CaptureLoop.
struct CaptureRequest
{
  Demand demand = Demand::kStopped;
  bool stop = false;
  bool new_pace = false;  // whether framerate and loop have been set since the last request was taken
  double framerate = 0.0;
  bool loop = false;
};

}  // namespace

/// The capturing thread and what it works with.
class CaptureLoop::Reader
{
public:
  Reader(const CaptureParams& params, CaptureListener& listener, const Open& open)
    : params_(params), listener_(listener), open_(open), watchdog_(params.timeout)
  {
    validate(params);
    params_.kind = sourceKind(params);  // the source stays of this kind, whatever becomes of its path
    live_ = mayComeLater(*params_.kind);
    if (!live_) this->open();  // the caller must not wait for a device or a server
    thread_ = std::thread(&Reader::run, this);
  }

  ~Reader()
  {
    ask([](CaptureRequest& request) { request.stop = true; });
    thread_.join();
  }

  /// Changes what is asked of the thread.
  template <class Change>
  void ask(Change change)
  {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      change(request_);
    }
    changed_.notify_all();
  }

private:
  CaptureRequest takeRequest()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    taken_ = request_;
    request_.new_pace = false;
    return taken_;
  }

  /// Returns true at this time, or false as soon as something else is asked than was taken last.
  bool waitUntil(Clock::time_point time)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    const auto asked = [this] { return request_.stop || request_.new_pace || request_.demand != taken_.demand; };
    return !changed_.wait_until(lock, time, asked);
  }

  void run()
  {
    for (CaptureRequest request = takeRequest(); !request.stop; request = takeRequest())
    {
      try
      {
        follow(request);
      }
      catch (const std::exception& e)  // the source could be neither read on nor opened or rewound again
      {
        if (live_)
          onDisconnected(e.what());
        else
          finish(e.what());
      }
    }
  }

  void follow(const CaptureRequest& request)
  {
    if (request.new_pace) setPace(request.framerate, request.loop);
    if (request.demand != Demand::kFrames || ended_)
      idle(request.demand);
    else if (!source_)
      retry();
    else if (source_->rate() == 0.0 || waitUntil(next_frame_))
      readFrame(request);
  }

  void setPace(double framerate, bool loop)
  {
    next_frame_ = Clock::now();
    const bool is_new = framerate != params_.framerate;
    params_.framerate = framerate;
    if (is_new && params_.kind == SourceKind::kDevice)
      source_.reset();  // it takes its rate when it is opened
    else if (is_new && source_ && source_->setRate(wantedRate(params_)))
      listener_.onOpened(*source_);
    if (!ended_ || !loop || !source_) return;
    source_->rewind();
    ended_ = false;
  }

  /// Waits for the next request. A source that is not there is still looked for, and so is a device that is not used:
  /// users are told at once that it is absent.
  void idle(Demand demand)
  {
    if (source_ && source_->rate() == 0.0) source_.reset();
    if (!available_ && !ended_ && demand != Demand::kStopped) return retry();
    if (!ended_) listener_.onIdle();
    const bool polls = demand == Demand::kIdle && !device_file_.empty();
    bool there = true;
    while (there && waitUntil(Clock::now() + kProbePeriod))
      there = !polls || access(device_file_.c_str(), F_OK) == 0;
    available_ = available_ && there;
    next_frame_ = Clock::now();
  }

  void retry()
  {
    if (waitUntil(next_try_)) open();
  }

  void open()
  try
  {
    source_ = open_(params_);
    available_ = true;
    next_frame_ = Clock::now();
    watchdog_.onFrame();
    const std::shared_ptr<V4l2Device> device = source_->device();
    device_file_ = device ? device->path() : "";
    listener_.onOpened(*source_);
  }
  catch (const SourceUnavailable& e)
  {
    onDisconnected(e.what());
  }

  void onDisconnected(const std::string& reason)
  {
    source_.reset();
    available_ = false;
    // Another reason is news: the device may be back, but cannot be opened yet.
    retry_delay_ =
        reason == last_reason_ ? std::min<Clock::duration>(2 * retry_delay_, kMaxRetryDelay) : kMinRetryDelay;
    last_reason_ = reason;
    next_try_ = Clock::now() + retry_delay_;
    listener_.onUnavailable(reason);
  }

  void readFrame(const CaptureRequest& request)
  try
  {
    Frame frame;
    frame.wanted = listener_.wantedViews();
    if (source_->fillsMemory()) listener_.prepare(frame);
    switch (source_->read(frame))
    {
      case ReadResult::kFrame:
        read_since_rewind_ = true;
        listener_.onFrame(frame);
        watchdog_.onFrame();
        last_reason_.clear();
        scheduleNext(request.framerate);
        break;
      case ReadResult::kNoImage:
        watchdog_.onData();
        [[fallthrough]];
      case ReadResult::kTimeout:
        if (const std::string reason = watchdog_.stall(*source_, "no frame"); !reason.empty())
          throw SourceUnavailable(reason);
        break;
      case ReadResult::kEnd:
        end("", request.loop);
        break;
    }
  }
  catch (const SourceUnavailable& e)
  {
    onDisconnected(e.what());
  }
  catch (const SourceError& e)
  {
    end(e.what(), request.loop);
  }
  catch (const std::exception& e)
  {
    listener_.onRefused(e.what());
    const std::string reason = watchdog_.stall(*source_, "no good frame");
    if (reason.empty())
      scheduleNext(request.framerate);
    else
      onDisconnected(reason);
  }

  /// Sets when the frame after this one is due, unless the source itself waits for it.
  void scheduleNext(double framerate)
  {
    const double own_rate = source_->rate();
    if (own_rate == 0.0) return;
    const std::chrono::duration<double> wanted(std::min(1.0 / (framerate > 0.0 ? framerate : own_rate), kMaxPeriod));
    const auto period = std::chrono::duration_cast<Clock::duration>(wanted);
    // One late frame is made up for, but a machine that is too slow must not gather a backlog.
    next_frame_ = std::max(next_frame_ + period, Clock::now() - period);
  }

  void end(const std::string& error, bool loop)
  {
    if (!loop || !read_since_rewind_) return finish(error);
    if (!error.empty()) listener_.onRefused(error);
    read_since_rewind_ = false;
    source_->rewind();
  }

  void finish(const std::string& error)
  {
    ended_ = true;
    listener_.onEnd(error);
  }

  CaptureParams params_;
  CaptureListener& listener_;
  Open open_;
  bool live_ = false;  // a live source is never given up: what is not there, or fails, may be there again
  FrameWatchdog watchdog_;
  std::unique_ptr<FrameSource> source_;
  std::string device_file_;  // of a source that is a device
  bool available_ = false;   // whether the last try to open the source, or to read it, went well
  bool ended_ = false;
  bool read_since_rewind_ = false;  // else looping would spin on an empty source
  Clock::time_point next_frame_;    // when it is due
  Clock::time_point next_try_;      // to open the source
  Clock::duration retry_delay_{};
  std::string last_reason_;  // of the last disconnection, empty if a frame has come since
  std::mutex mutex_;         // guards request_ and taken_
  std::condition_variable changed_;
  CaptureRequest request_;
  CaptureRequest taken_;
  std::thread thread_;
};

CaptureLoop::CaptureLoop(const CaptureParams& params, CaptureListener& listener, const Open& open)
  : reader_(std::make_unique<Reader>(params, listener, open))
{
}

CaptureLoop::~CaptureLoop() = default;

void CaptureLoop::setDemand(Demand demand)
{
  reader_->ask([=](CaptureRequest& request) { request.demand = demand; });
}

void CaptureLoop::setPace(double framerate, bool loop)
{
  reader_->ask(
      [=](CaptureRequest& request)
      {
        request.new_pace = true;
        request.framerate = framerate;
        request.loop = loop;
      });
}

}  // namespace robot_vision
