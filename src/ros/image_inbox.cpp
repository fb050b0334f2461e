#include "image_inbox.hpp"

#include <algorithm>
#include <utility>

#include "image_message.hpp"
#include "transports.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kInfos = 10;  // how far camera_info may run ahead of its picture

}  // namespace

ImageInbox::ImageInbox(const Params& params, const ros::NodeHandle& nh,
                       const std::shared_ptr<image_transport::ImageTransport>& it,
                       std::shared_ptr<FrameStatistics> statistics)
  : params_(params), nh_(nh), it_(it), statistics_(std::move(statistics))
{
  requireTransport(*it, params_.transport);
  statistics_->setIdle();
}

void ImageInbox::open()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto it = it_.lock();
  if (open_ || !it) return;
  open_ = true;
  statistics_->resumed();
  statistics_->setRunning(params_.topic);
  // A queue of one: after a slow frame the newest is next. Small packets must not wait for each other.
  const ros::TransportHints no_delay = ros::TransportHints().tcpNoDelay();
  if (!params_.camera_info_topic.empty())
    info_subscriber_ = nh_.subscribe<sensor_msgs::CameraInfo>(
        params_.camera_info_topic, kInfos, [this](const sensor_msgs::CameraInfoConstPtr& info) { onCameraInfo(info); },
        ros::VoidConstPtr(), no_delay);
  const image_transport::TransportHints hints(params_.transport, no_delay, ros::NodeHandle(params_.parameters));
  subscriber_ = it->subscribe(
      params_.topic, 1, [this](const sensor_msgs::ImageConstPtr& message) { onImage(message); }, ros::VoidPtr(), hints);
}

void ImageInbox::close()
{
  image_transport::Subscriber subscriber;
  ros::Subscriber info_subscriber;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!open_) return;
    open_ = false;
    std::swap(subscriber, subscriber_);
    std::swap(info_subscriber, info_subscriber_);
    newest_.reset();
    infos_.clear();
    statistics_->setIdle();
  }
  subscriber.shutdown();  // waits for a callback under way, which takes the lock
  info_subscriber.shutdown();
}

std::uint32_t ImageInbox::publishers() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return open_ ? subscriber_.getNumPublishers() : 0;
}

void ImageInbox::onImage(const sensor_msgs::ImageConstPtr& message)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (open_) newest_ = message;
}

void ImageInbox::onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  infos_.push_back(info);
  if (infos_.size() > kInfos) infos_.pop_front();
}

sensor_msgs::CameraInfoConstPtr ImageInbox::infoOf(const sensor_msgs::Image& image) const
{
  const auto found = std::find_if(infos_.begin(), infos_.end(),
                                  [&image](const auto& info) { return info->header.stamp == image.header.stamp; });
  return found == infos_.end() ? nullptr : *found;
}

std::optional<ReceivedImage> ImageInbox::take()
{
  ReceivedImage received;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!newest_) return std::nullopt;
    if (!params_.camera_info_topic.empty())
    {
      received.camera_info = infoOf(*newest_);
      if (!received.camera_info) return std::nullopt;  // it may still come
    }
    received.message = std::move(newest_);
  }
  taken_ = received.message;
  taken_at_ = FrameStatistics::Clock::now();
  statistics_->received(taken_->header.seq);
  try
  {
    const bool as_it_is = params_.encoding.empty();
    received.encoding = as_it_is ? taken_->encoding : params_.encoding;
    received.pixels = as_it_is ? viewAnyPixels(*taken_) : convertPixels(*taken_, params_.encoding);
  }
  catch (const std::exception& e)
  {
    refuse(e.what());
    return std::nullopt;
  }
  return received;
}

void ImageInbox::finished()
{
  statistics_->published(taken_at_, taken_->header.stamp);
}

void ImageInbox::failed(const std::string& why)
{
  statistics_->refused(why);
}

void ImageInbox::refuse(const std::string& why)
{
  const std::string what = describeRefusal(*taken_, params_.topic, why);
  statistics_->refused(what);
  if (throttle_.due()) ROS_ERROR("%s", what.c_str());
}

}  // namespace robot_vision
