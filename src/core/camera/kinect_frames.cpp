#include "kinect_frames.hpp"

#include <cmath>
#include <cstdlib>
#include <utility>

#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

KinectFrames::KinectFrames(cv::Size color_size, int color_type, cv::Size depth_size)
{
  for (int place = 0; place < kPlaces; ++place)
  {
    const auto index = static_cast<std::size_t>(place);
    at(KinectCamera::kColor).images[index] = cv::Mat::zeros(color_size, color_type);
    at(KinectCamera::kDepth).images[index] = cv::Mat::zeros(depth_size, CV_16UC1);
  }
}

void KinectFrames::arrived(KinectCamera camera, std::uint32_t ticks, std::int64_t monotonic_ns)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  Camera& one = at(camera);
  Camera& other = at(camera == KinectCamera::kColor ? KinectCamera::kDepth : KinectCamera::kColor);
  if (!one.wanted) return;
  std::swap(one.images[kFilling], one.images[kWaiting]);
  one.waits = true;
  one.ticks = ticks;
  if (!other.wanted) return complete(monotonic_ns);
  if (!other.waits) return;
  const auto gap = static_cast<std::int32_t>(ticks - other.ticks);  // right even if the clock has wrapped in between
  if (std::abs(static_cast<std::int64_t>(gap)) > kMaxKinectGap)
  {
    (gap > 0 ? other : one).waits = false;  // the older one has missed its like
    return;
  }
  complete(monotonic_ns - std::llround(std::abs(0.5e9 / kKinectTickRate * gap)));
}

void KinectFrames::complete(std::int64_t monotonic_ns)
{
  for (Camera& camera : cameras_)
  {
    camera.ready = camera.wanted;
    if (camera.ready) std::swap(camera.images[kWaiting], camera.images[kReady]);
    camera.waits = false;
  }
  monotonic_ns_ = monotonic_ns;
  ++next_sequence_;
  ready_ = true;
  changed_.notify_all();
}

void KinectFrames::end(const std::string& reason)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  ended_ = true;
  reason_ = reason;
  changed_.notify_all();
}

void KinectFrames::want(bool color, bool depth)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  at(KinectCamera::kColor).wanted = color;
  at(KinectCamera::kDepth).wanted = depth;
}

bool KinectFrames::wanted(KinectCamera camera)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return at(camera).wanted;
}

bool KinectFrames::take(std::chrono::milliseconds timeout, KinectFrame& frame)
{
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait_for(lock, timeout, [this] { return ready_ || ended_; });
  if (!ready_ && ended_) throw SourceUnavailable(reason_);
  if (!ready_) return false;
  ready_ = false;
  for (Camera& camera : cameras_)
    if (camera.ready) std::swap(camera.images[kReady], camera.images[kTaken]);
  const auto image_of = [this](KinectCamera camera)
  { return at(camera).ready ? at(camera).images[kTaken] : cv::Mat(); };
  frame = {image_of(KinectCamera::kColor), image_of(KinectCamera::kDepth), next_sequence_ - 1, monotonic_ns_};
  return true;
}

}  // namespace robot_vision
