#include "live_frames.hpp"

#include <stdexcept>
#include <utility>

#include "robot_vision/common/monotonic.hpp"

namespace robot_vision
{

LiveFrames::LiveFrames(Grab grab, Retrieve retrieve) : grab_(std::move(grab)), retrieve_(std::move(retrieve))
{
}

LiveFrames::~LiveFrames()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  if (thread_.joinable()) thread_.join();
}

bool LiveFrames::take(Frame& frame)
{
  std::unique_lock<std::mutex> lock(mutex_);
  if (!kept_ && damage_.empty())
  {
    awaited_ = &frame;
    if (!thread_.joinable()) thread_ = std::thread(&LiveFrames::run, this);
    changed_.wait(lock, [this] { return awaited_ == nullptr || ended_; });
  }
  if (!damage_.empty()) throw std::invalid_argument(std::exchange(damage_, ""));
  if (!kept_) return awaited_ == nullptr;
  frame.image = kept_->image;
  frame.sequence = kept_->sequence;
  frame.monotonic_ns = kept_->monotonic_ns;
  kept_.reset();
  return true;
}

void LiveFrames::run()
{
  std::string error;
  try
  {
    readAll();
  }
  catch (const std::exception& e)
  {
    error = e.what();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!error.empty()) damage_ = error;
  ended_ = true;
  changed_.notify_all();
}

void LiveFrames::readAll()
{
  while (grab_())
  {
    const std::int64_t arrival = monotonicNow();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (stop_) return;
    if (awaited_ != nullptr)
      give(arrival);
    else if (behind_)
      leaveOut();
    else
      keep(arrival);
  }
}

void LiveFrames::give(std::int64_t arrival)
{
  behind_ = behind_ && std::exchange(left_out_, false);
  makeImage(*awaited_, arrival);
  awaited_ = nullptr;
  changed_.notify_all();
}

void LiveFrames::keep(std::int64_t arrival)
{
  behind_ = kept_.has_value();
  kept_.emplace();
  if (!makeImage(*kept_, arrival)) kept_.reset();
}

void LiveFrames::leaveOut()
{
  left_out_ = true;
  kept_.reset();
  ++sequence_;
}

/// Makes the frame that was grabbed last; false if it is damaged, which the reader is told.
bool LiveFrames::makeImage(Frame& frame, std::int64_t arrival)
{
  const std::string damage = retrieveInto(frame.image);
  if (!damage.empty())
  {
    damage_ = damage;
    return false;
  }
  frame.monotonic_ns = arrival;
  frame.sequence = sequence_++;
  return true;
}

std::string LiveFrames::retrieveInto(cv::Mat& image)
try
{
  return retrieve_(image) ? "" : "a frame cannot be decoded";
}
catch (const std::exception& e)
{
  return e.what();
}

}  // namespace robot_vision
