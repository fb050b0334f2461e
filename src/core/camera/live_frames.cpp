#include "live_frames.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace robot_vision
{

LiveFrames::LiveFrames(Grab grab, Retrieve retrieve, Clock now)
  : grab_(std::move(grab)), retrieve_(std::move(retrieve)), now_(std::move(now))
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
  if (thread_.joinable())
    work_ = now_() - begin_;
  else
    thread_ = std::thread(&LiveFrames::run, this);
  if (!kept_ && kept_damage_.empty())
  {
    awaited_ = &frame;
    changed_.wait(lock, [this] { return awaited_ == nullptr || ended_; });
    // Others may have come since it was given.
    if (std::exchange(awaited_, nullptr) == nullptr)
    {
      if (!damage_.empty()) throw std::invalid_argument(std::exchange(damage_, ""));
      return true;
    }
  }
  begin_ = now_();
  if (!kept_damage_.empty()) throw std::invalid_argument(std::exchange(kept_damage_, ""));
  if (!kept_) return false;
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
  if (!error.empty()) kept_damage_ = error;
  ended_ = true;
  changed_.notify_all();
}

void LiveFrames::readAll()
{
  while (grab_())
  {
    const std::int64_t arrival = now_();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (stop_) return;
    follow(arrival);
    if (awaited_ != nullptr)
      give(arrival);
    else if (kept_ || mayBeWanted(arrival))
      keep(arrival);
    else
      ++sequence_;
  }
}

void LiveFrames::follow(std::int64_t arrival)
{
  constexpr std::size_t kGaps = 16;  // some bursts have fewer
  if (arrival_) gaps_.push_back(arrival - *arrival_);
  if (gaps_.size() > kGaps) gaps_.pop_front();
  arrival_ = arrival;
}

void LiveFrames::give(std::int64_t arrival)
{
  damage_ = makeImage(*awaited_, arrival);
  awaited_ = nullptr;
  begin_ = now_();
  changed_.notify_all();
}

void LiveFrames::keep(std::int64_t arrival)
{
  Frame frame;
  const std::string damage = makeImage(frame, arrival);
  if (damage.empty())
    kept_ = frame;
  else
    kept_damage_ = damage;
}

/// Whether the reader may be back before the next frame comes, if it works as long as before. Frames may come in
/// bursts, and this one be the last before a pause.
bool LiveFrames::mayBeWanted(std::int64_t arrival) const
{
  return gaps_.empty() || arrival + *std::max_element(gaps_.begin(), gaps_.end()) >= begin_ + work_;
}

/// Makes the image of the frame that was grabbed last. Returns what is damaged, or nothing.
std::string LiveFrames::makeImage(Frame& frame, std::int64_t arrival)
{
  const std::string damage = retrieveInto(frame.image);
  if (!damage.empty()) return damage;
  frame.monotonic_ns = arrival;
  frame.sequence = sequence_++;
  return "";
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
