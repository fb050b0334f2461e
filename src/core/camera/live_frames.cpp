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
  awaited_ = &frame;
  if (!thread_.joinable()) thread_ = std::thread(&LiveFrames::run, this);
  changed_.wait(lock, [this] { return awaited_ == nullptr || ended_; });
  if (!damage_.empty()) throw std::invalid_argument(std::exchange(damage_, ""));
  return awaited_ == nullptr;
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
  std::int64_t sequence = 0;
  while (grab_())
  {
    const std::int64_t arrival = monotonicNow();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (stop_) return;
    const bool skipped = awaited_ == nullptr;
    if (skipped || give(sequence, arrival)) ++sequence;
  }
}

/// Gives the reader who waits the frame that was grabbed last; false if it is damaged, which the reader is told.
bool LiveFrames::give(std::int64_t sequence, std::int64_t arrival)
{
  damage_ = retrieveInto(awaited_->image);
  awaited_->sequence = sequence;
  awaited_->monotonic_ns = arrival;
  awaited_ = nullptr;
  changed_.notify_all();
  return damage_.empty();
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
