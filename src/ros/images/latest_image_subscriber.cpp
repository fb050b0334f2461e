#include "latest_image_subscriber.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include "camera_info.hpp"
#include "image_message.hpp"
#include "subscribing_lock.hpp"
#include "waiting_images.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxUnpaired = 10;  // messages by which images and camera_info may be ahead of each other

}  // namespace

LatestImageSubscriber::LatestImageSubscriber(const Params& params, Node node,
                                             std::shared_ptr<FrameStatistics> statistics)
  : params_(params), node_(std::move(node)), statistics_(std::move(statistics))
{
  if (!params_.encoding.empty()) anyMatType(params_.encoding);
  statistics_->setIdle();
}

void LatestImageSubscriber::open()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (open_) return;
  }
  const std::shared_ptr<ProcessImages> images = node_.subscriptions->take(params_.topic, params_.transport);
  if (!images) return;  // the process ends
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (open_ || ended_) return;
    images_ = images;
    open_ = true;
    statistics_->resumed();
    statistics_->setRunning(params_.topic);
  }
  // This is done without the lock, because it calls the master, and close() must not wait for that.
  ros::Subscriber info_subscriber;
  try
  {
    if (!params_.camera_info_topic.empty())
      info_subscriber = subscribeToCameraInfo(node_.nh, params_.camera_info_topic, kMaxUnpaired,
                                              [this](const auto& info) { onCameraInfo(info); });
    images->add(*this, params_.parameters);
  }
  catch (const std::exception& e)
  {
    close();
    images->remove(*this);  // which close() has not done if it was closed meanwhile
    endSubscription(info_subscriber);
    statistics_->setUnsubscribed(e.what());
    throw;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (open_) return std::swap(info_subscriber, info_subscriber_);
  }
  images->remove(*this);  // it was closed meanwhile, perhaps before it was added
  endSubscription(info_subscriber);
}

void LatestImageSubscriber::close()
{
  std::shared_ptr<ProcessImages> images;
  ros::Subscriber info_subscriber;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    statistics_->setIdle();  // also in place of an error
    if (!open_) return;
    open_ = false;
    std::swap(images, images_);
    std::swap(info_subscriber, info_subscriber_);
    frames_.clear();
    infos_.clear();
  }
  images->remove(*this);
  endSubscription(info_subscriber);  // waits for a running callback, which needs the lock
}

void LatestImageSubscriber::end()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
  }
  close();
}

std::shared_ptr<ProcessImages> LatestImageSubscriber::images() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return images_;
}

std::uint32_t LatestImageSubscriber::publishers() const
{
  const std::shared_ptr<ProcessImages> open = images();
  return open ? open->publishers() : 0;
}

void LatestImageSubscriber::onFrame(const std::shared_ptr<ProcessFrame>& frame)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!open_) return;
  frames_.push_back(frame);
  const bool waits = !params_.camera_info_topic.empty();
  const auto image_of = [](const auto& one) -> const auto&
  {
    return *one->message();
  };
  if (dropOldest(frames_, waits ? kMaxUnpaired : 1, image_of) && waits && throttle_.due())
    ROS_WARN("images of %s without a camera_info of the same stamp on %s", params_.topic.c_str(),
             params_.camera_info_topic.c_str());
}

void LatestImageSubscriber::onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!open_) return;
  infos_.push_back(info);
  if (infos_.size() > kMaxUnpaired) infos_.pop_front();
}

sensor_msgs::CameraInfoConstPtr LatestImageSubscriber::infoOf(const sensor_msgs::Image& image) const
{
  const auto found = std::find_if(infos_.rbegin(), infos_.rend(),
                                  [&image](const auto& info) { return info->header.stamp == image.header.stamp; });
  return found == infos_.rend() ? nullptr : *found;
}

/// The newest frame that can be taken, whose camera_info is put beside it; null if there is none.
std::shared_ptr<ProcessFrame> LatestImageSubscriber::takeNewest(ReceivedImage& received)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto frame = frames_.rbegin(); frame != frames_.rend(); ++frame)
  {
    if (!params_.camera_info_topic.empty())
    {
      received.camera_info = infoOf(*(*frame)->message());
      if (!received.camera_info) continue;  // its camera_info may still come
    }
    std::shared_ptr<ProcessFrame> newest = *frame;
    frames_.erase(frames_.begin(), frame.base());  // with all older ones
    return newest;
  }
  return nullptr;
}

std::optional<ReceivedImage> LatestImageSubscriber::take()
{
  statistics_->setWaiting(true);
  if (const std::shared_ptr<ProcessImages> open = images()) open->receive();
  ReceivedImage received;
  const std::shared_ptr<ProcessFrame> frame = takeNewest(received);
  if (!frame) return std::nullopt;
  const sensor_msgs::Image& message = *frame->message();
  received.header = message.header;
  taken_stamp_ = message.header.stamp;
  taken_at_ = FrameStatistics::Clock::now();
  statistics_->received(message.header.seq);
  try
  {
    received.encoding = params_.encoding.empty() ? message.encoding : params_.encoding;
    received.pixels = frame->pixels(params_.encoding);
  }
  catch (const std::exception& e)
  {
    refuse(message, e.what());
    return std::nullopt;
  }
  statistics_->setWaiting(false);
  return received;
}

void LatestImageSubscriber::finished()
{
  statistics_->published(taken_at_, taken_stamp_);
}

void LatestImageSubscriber::finishedLater(double processing_s, const ros::Time& stamp)
{
  const std::chrono::duration<double> spent(processing_s);
  const auto now = FrameStatistics::Clock::now();
  statistics_->published(now - std::chrono::duration_cast<FrameStatistics::Clock::duration>(spent), stamp);
}

void LatestImageSubscriber::failed(const std::string& reason)
{
  statistics_->refused(reason);
}

void LatestImageSubscriber::refuse(const sensor_msgs::Image& message, const std::string& reason)
{
  const std::string what = describeRefusal(message, params_.topic, reason);
  statistics_->refused(what);
  if (throttle_.due()) ROS_ERROR("%s", what.c_str());
}

}  // namespace robot_vision
