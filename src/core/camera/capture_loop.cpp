#include "capture_loop.hpp"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include "robot_vision/common/range.hpp"
#include "v4l2_device.hpp"

namespace robot_vision
{
namespace
{

// A driver is up again in no time after an error; a device that was unplugged need not be looked for all the time.
constexpr std::chrono::milliseconds kFirstRetry{100};
constexpr std::chrono::milliseconds kLastRetry{1000};
constexpr std::chrono::seconds kLookAround{1};  // between looks whether a device is there that nobody uses
constexpr double kLongestPeriod = 1e6;          // s, far from the clock's limits
constexpr double kPeriods = 3.0;                // without a frame, of a camera so slow that this is longer than timeout
constexpr double kMaxFrameTimeout = 30.0;       // s, with a camera that tells of longer periods than timeout
constexpr double kLongestGroup = 30.0;          // s, of a stream from keyframe to keyframe

double secondsSince(std::chrono::steady_clock::time_point time)
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - time).count();
}

/// The parameters of a source that stays what it is now.
CaptureParams settled(CaptureParams params)
{
  params.kind = sourceKind(params);
  return params;
}

}  // namespace

double frameTimeoutFor(double period, double timeout)
{
  return std::max(timeout, std::min(kPeriods * period, kMaxFrameTimeout));
}

CaptureLoop::CaptureLoop(const CaptureParams& params, CaptureListener& listener, Open opener)
  : params_(settled(params)), listener_(listener), open_(std::move(opener)), live_(mayComeLater(*params_.kind))
{
  validate(params);
  if (!live_) open();  // who has to wait for a device or server must not wait here
  thread_ = std::thread(&CaptureLoop::run, this);
}

CaptureLoop::~CaptureLoop()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    request_.stop = true;
  }
  changed_.notify_all();
  thread_.join();
}

void CaptureLoop::setDemand(Demand demand)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    request_.demand = demand;
  }
  changed_.notify_all();
}

void CaptureLoop::setPace(double framerate, bool loop)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    request_.new_pace = true;
    request_.framerate = framerate;
    request_.loop = loop;
  }
  changed_.notify_all();
}

CaptureLoop::CaptureRequest CaptureLoop::takeRequest()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const CaptureRequest request = request_;
  request_.new_pace = false;
  return request;
}

void CaptureLoop::run()
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
        lose(e.what());
      else
        finish(e.what());
    }
  }
}

void CaptureLoop::follow(const CaptureRequest& request)
{
  if (request.new_pace)
  {
    next_frame_ = Clock::now();
    // A device and the scene take their rate when they are opened.
    const bool has_rate = source_ && (source_->rate() == 0.0 || params_.source == "synthetic");
    if (has_rate && request.framerate != params_.framerate) source_.reset();
    params_.framerate = request.framerate;
    if (ended_ && request.loop && source_)
    {
      source_->rewind();
      ended_ = false;
    }
  }
  if (request.demand != Demand::kFrames || ended_)
    idle(request.demand);
  else if (!source_)
    retry();
  else if (source_->rate() == 0.0 || waitUntil(next_frame_))
    readFrame(request);
}

/// Waits for new request. A source that was not there, or that is unplugged, is looked for meanwhile, so that its
/// absence is told at once.
void CaptureLoop::idle(Demand demand)
{
  if (source_ && source_->rate() == 0.0) source_.reset();
  if (!available_ && !ended_ && demand != Demand::kStopped)
  {
    retry();
    return;
  }
  if (!ended_) listener_.onIdle();
  std::unique_lock<std::mutex> lock(mutex_);
  const auto ordered = [this, demand] { return request_.stop || request_.new_pace || request_.demand != demand; };
  const bool looks = demand == Demand::kIdle && !device_file_.empty();
  bool there = true;
  while (there && !changed_.wait_for(lock, kLookAround, ordered))
    there = !looks || access(device_file_.c_str(), F_OK) == 0;
  available_ = available_ && there;
  next_frame_ = Clock::now();
}

void CaptureLoop::retry()
{
  if (waitUntil(next_try_)) open();
}

void CaptureLoop::open()
{
  try
  {
    source_ = open_(params_);
    available_ = true;
    next_frame_ = last_frame_ = last_sign_ = Clock::now();
    frame_timeout_.reset();
    const std::shared_ptr<V4l2Device> device = source_->device();
    device_file_ = device ? device->path() : "";
    listener_.onOpened(*source_);
  }
  catch (const SourceUnavailable& e)
  {
    lose(e.what());
  }
}

void CaptureLoop::lose(const std::string& why)
{
  source_.reset();
  available_ = false;
  // Another reason is news: the device is back, but may not be opened yet.
  retry_ = why == loss_ ? std::min<Clock::duration>(2 * retry_, kLastRetry) : kFirstRetry;
  loss_ = why;
  next_try_ = Clock::now() + retry_;
  listener_.onUnavailable(why);
}

/// Sets when the frame after this one is due.
void CaptureLoop::pace(double framerate)
{
  const double own_rate = source_->rate();
  if (own_rate == 0.0) return;
  const std::chrono::duration<double> wanted(std::min(1.0 / (framerate > 0.0 ? framerate : own_rate), kLongestPeriod));
  const auto period = std::chrono::duration_cast<Clock::duration>(wanted);
  // One late frame is made up for; too slow a machine must not gather a backlog.
  next_frame_ = std::max(next_frame_ + period, Clock::now() - period);
}

/// False if an order came instead.
bool CaptureLoop::waitUntil(Clock::time_point time)
{
  std::unique_lock<std::mutex> lock(mutex_);
  const Demand demand = request_.demand;
  const auto ordered = [this, demand] { return request_.stop || request_.new_pace || request_.demand != demand; };
  return !changed_.wait_until(lock, time, ordered);
}

void CaptureLoop::readFrame(const CaptureRequest& request)
{
  try
  {
    Frame frame;
    if (source_->fillsMemory()) listener_.prepare(frame);
    const ReadResult result = source_->read(frame);
    if (result == ReadResult::kEnd) end("", request.loop);
    if (result == ReadResult::kNoPicture) last_sign_ = Clock::now();
    if (result == ReadResult::kTimeout || result == ReadResult::kNoPicture)
      if (const std::string why = stall("no frame"); !why.empty()) throw SourceUnavailable(why);
    if (result != ReadResult::kFrame) return;  // the one that is due is still to come
    read_since_rewind_ = true;
    listener_.onFrame(frame);
    last_frame_ = last_sign_ = Clock::now();
    frame_timeout_.reset();
    loss_.clear();
  }
  catch (const SourceUnavailable& e)
  {
    lose(e.what());
    return;
  }
  catch (const SourceError& e)
  {
    end(e.what(), request.loop);
    return;
  }
  catch (const std::exception& e)
  {
    listener_.onRefused(e.what());
    if (const std::string why = stall("no good frame"); !why.empty())
    {
      lose(why);
      return;
    }
  }
  pace(request.framerate);
}

/// What to say of a live source that has given no good frame for too long; empty if it is not too long yet. Files have
/// no time to keep.
std::string CaptureLoop::stall(const std::string& what)
{
  const double without_picture = secondsSince(last_frame_);
  if (source_->rate() != 0.0 || without_picture <= params_.timeout) return "";
  const auto text = [this](const std::string& missing, double seconds)
  { return source_->description() + ": " + missing + " for " + toText(seconds) + " s"; };
  if (!frame_timeout_) frame_timeout_ = frameTimeoutFor(source_->period(), params_.timeout);
  if (secondsSince(last_sign_) > *frame_timeout_) return text(what, *frame_timeout_);
  const double group = std::max(*frame_timeout_, kLongestGroup);
  return without_picture > group ? text("no keyframe", group) : "";
}

void CaptureLoop::end(const std::string& error, bool loop)
{
  if (!loop || !read_since_rewind_)
  {
    finish(error);
    return;
  }
  if (!error.empty()) listener_.onRefused(error);
  read_since_rewind_ = false;
  source_->rewind();
}

void CaptureLoop::finish(const std::string& error)
{
  ended_ = true;
  listener_.onEnd(error);
}

}  // namespace robot_vision
