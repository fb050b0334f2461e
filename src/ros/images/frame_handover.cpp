#include "frame_handover.hpp"

#include <algorithm>

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxDelivered = 32;  // frames by which one way may be ahead of the other

}  // namespace

bool FrameHandover::begin(Way way, const std_msgs::Header& header)
{
  std::unique_lock<std::mutex> lock(mutex_);
  if (deliverer_ == std::this_thread::get_id()) return false;  // a callback that spins would wait for itself
  changed_.wait(lock, [this] { return !deliverer_ || closed_; });
  if (closed_) return false;
  if (way != way_)
  {
    if (allowed_ != way) return false;
    way_ = way;
    allowed_.reset();
    if (way == Way::kShared) shift_ = last_ ? *last_ + 1 - header.seq : 0;
  }
  if (wasDelivered(way, header)) return false;
  last_ = numberOf(way, header);
  remember(way, header);
  deliverer_ = std::this_thread::get_id();
  return true;
}

/// A frame of the other way stands for one of this: there are senders whose headers are all the same.
bool FrameHandover::wasDelivered(Way way, const std_msgs::Header& header)
{
  const auto found = find(way == Way::kRaw ? Way::kShared : Way::kRaw, header);
  if (found == delivered_.end()) return false;
  if (way == Way::kShared) shift_ = found->sequence - header.seq;
  delivered_.erase(found);
  return true;
}

void FrameHandover::remember(Way way, const std_msgs::Header& header)
{
  if (find(way, header) != delivered_.end()) return;
  delivered_.push_back({way, numberOf(way, header), header.stamp, header.frame_id});
  if (delivered_.size() > kMaxDelivered) delivered_.pop_front();
}

std::uint32_t FrameHandover::numberOf(Way way, const std_msgs::Header& header) const
{
  return way == Way::kRaw ? header.seq : header.seq + shift_;
}

std::uint32_t FrameHandover::sequence(const std_msgs::Header& header) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return numberOf(way_, header);
}

/// Without the frame's number, which differs between the ways.
std::deque<FrameHandover::Delivered>::iterator FrameHandover::find(Way way, const std_msgs::Header& header)
{
  return std::find_if(delivered_.begin(), delivered_.end(),
                      [&](const Delivered& other)
                      { return other.way == way && other.stamp == header.stamp && other.frame_id == header.frame_id; });
}

void FrameHandover::finish()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    deliverer_.reset();
  }
  changed_.notify_all();
}

bool FrameHandover::accepts(Way way) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return !closed_ && (way == way_ || way == allowed_);
}

void FrameHandover::allow(std::optional<Way> way)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  allowed_ = way;
}

void FrameHandover::take(Way way)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  way_ = way;
  allowed_.reset();
}

FrameHandover::Way FrameHandover::way() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return way_;
}

bool FrameHandover::close()
{
  std::unique_lock<std::mutex> lock(mutex_);
  closed_ = true;
  changed_.notify_all();
  if (deliverer_ == std::this_thread::get_id()) return false;
  changed_.wait(lock, [this] { return !deliverer_; });
  return true;
}

}  // namespace robot_vision
