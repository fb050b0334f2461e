#include "live_frames.hpp"

#include <stdexcept>
#include <utility>

#include "robot_vision/common/monotonic.hpp"

namespace robot_vision
{

LiveFrames::LiveFrames(Grab grab, Retrieve retrieve)
  : grab_(std::move(grab)), retrieve_(std::move(retrieve)), thread_(&LiveFrames::run, this)
{
}

LiveFrames::~LiveFrames()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  thread_.join();
}

bool LiveFrames::take(LiveFrame& frame)
{
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return ready_ || ended_ || !damage_.empty(); });
  if (!damage_.empty()) throw std::invalid_argument(std::exchange(damage_, ""));
  if (!ready_) return false;
  ready_ = false;
  std::swap(newest_, frame);  // the memory of the frame that was taken before is that of one to come
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
  LiveFrame frame;
  while (grab_())
  {
    frame.monotonic_ns = monotonicNow();
    const std::string damage = retrieveInto(frame.image);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (stop_) return;
    if (damage.empty())
    {
      const std::int64_t next = frame.sequence + 1;
      std::swap(newest_, frame);
      frame.sequence = next;
      ready_ = true;
    }
    else
      damage_ = damage;
    changed_.notify_all();
  }
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
