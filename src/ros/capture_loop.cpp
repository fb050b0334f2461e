#include "capture_loop.hpp"

#include <algorithm>

namespace robot_vision
{
namespace
{

constexpr std::chrono::seconds kRetry{1};
constexpr std::chrono::seconds kStalled{3};  // without a frame from a live source
constexpr double kLongestPeriod = 1e6;       // s, far from the clock's limits

}  // namespace

CaptureLoop::CaptureLoop(const CaptureParams& params, CaptureListener& listener) : params_(params), listener_(listener)
{
  validate(params);
  if (!mayComeLater(params)) open();  // who has to wait for a device or server must not wait here
  thread_ = std::thread(&CaptureLoop::run, this);
}

CaptureLoop::~CaptureLoop()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    orders_.stop = true;
  }
  changed_.notify_all();
  thread_.join();
}

void CaptureLoop::setWanted(bool wanted)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    orders_.wanted = wanted;
  }
  changed_.notify_all();
}

void CaptureLoop::setPace(double framerate, bool loop)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    orders_.new_pace = true;
    orders_.framerate = framerate;
    orders_.loop = loop;
  }
  changed_.notify_all();
}

CaptureLoop::Orders CaptureLoop::takeOrders()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const Orders orders = orders_;
  orders_.new_pace = false;
  return orders;
}

void CaptureLoop::run()
{
  for (Orders orders = takeOrders(); !orders.stop; orders = takeOrders())
  {
    try
    {
      follow(orders);
    }
    catch (const std::exception& e)  // the source could be neither read on nor opened or rewound again
    {
      finish(e.what());
    }
  }
}

void CaptureLoop::follow(const Orders& orders)
{
  if (orders.new_pace)
  {
    next_frame_ = Clock::now();
    // A device and the scene take their rate when they are opened.
    const bool has_rate = source_ && (source_->rate() == 0.0 || params_.source == "synthetic");
    if (has_rate && orders.framerate != params_.framerate) source_.reset();
    params_.framerate = orders.framerate;
    if (ended_ && orders.loop && source_)
    {
      source_->rewind();
      ended_ = false;
    }
  }
  if (!orders.wanted || ended_)
    idle();
  else if (!source_)
    retry();
  else if (source_->rate() == 0.0 || waitUntil(next_frame_))
    readFrame(orders);
}

/// Waits for new orders; a source that was not there is looked for meanwhile, so that its absence is told at once.
void CaptureLoop::idle()
{
  if (source_ && source_->rate() == 0.0) source_.reset();
  if (!available_ && !ended_)
  {
    retry();
    return;
  }
  if (!ended_) listener_.onIdle();
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return orders_.stop || orders_.new_pace || (orders_.wanted && !ended_); });
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
    source_ = openSource(params_);
    available_ = true;
    next_frame_ = Clock::now();
    last_frame_ = Clock::now();
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
  next_try_ = Clock::now() + kRetry;
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
  const bool was_wanted = orders_.wanted;
  const auto ordered = [this, was_wanted] { return orders_.stop || orders_.new_pace || orders_.wanted != was_wanted; };
  return !changed_.wait_until(lock, time, ordered);
}

void CaptureLoop::readFrame(const Orders& orders)
{
  try
  {
    Frame frame;
    listener_.prepare(frame);
    const ReadResult result = source_->read(frame);
    if (result == ReadResult::kEnd) end("", orders.loop);
    if (result == ReadResult::kTimeout && Clock::now() - last_frame_ > kStalled)
      throw SourceUnavailable(source_->description() + ": no frame for " + std::to_string(kStalled.count()) + " s");
    if (result != ReadResult::kFrame) return;  // the one that is due is still to come
    last_frame_ = Clock::now();
    read_since_rewind_ = true;
    listener_.onFrame(frame);
  }
  catch (const SourceUnavailable& e)
  {
    lose(e.what());
    return;
  }
  catch (const SourceError& e)
  {
    end(e.what(), orders.loop);
    return;
  }
  catch (const std::exception& e)
  {
    listener_.onRefused(e.what());
  }
  pace(orders.framerate);
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
