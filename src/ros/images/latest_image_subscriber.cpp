#include "latest_image_subscriber.hpp"

#include <algorithm>
#include <utility>

#include "bounded_reading.hpp"
#include "image_message.hpp"

namespace robot_vision
{
namespace
{

// TransportHints lets the parameter of this name override the given transport; there cannot be one of this name.
constexpr const char* kNoParameter = "image_transport/none";
constexpr std::size_t kMaxUnpaired = 10;  // messages by which images and camera_info may be ahead of each other

}  // namespace

LatestImageSubscriber::LatestImageSubscriber(const Params& params, const ros::NodeHandle& nh,
                                             const std::shared_ptr<image_transport::ImageTransport>& it,
                                             std::shared_ptr<FrameStatistics> statistics)
  : params_(params), nh_(nh), it_(it), statistics_(std::move(statistics))
{
  requireTransport(*it, params_.transport);
  if (!params_.encoding.empty()) anyMatType(params_.encoding);
  statistics_->setIdle();
}

void LatestImageSubscriber::open()
{
  const auto it = it_.lock();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (open_ || !it) return;
    open_ = true;
    statistics_->resumed();
    statistics_->setRunning(params_.topic);
  }
  // This is done without the lock, because it calls the master, and close() must not wait for that.
  ros::Subscriber info_subscriber;
  ImageSubscription subscription;
  try
  {
    // Without this option small packets would wait for each other.
    const ros::TransportHints no_delay = ros::TransportHints().tcpNoDelay();
    if (!params_.camera_info_topic.empty())
    {
      ros::SubscribeOptions options = boundedOptions<sensor_msgs::CameraInfo>(
          params_.camera_info_topic, kMaxUnpaired, [this](const auto& info) { onCameraInfo(info); });
      options.transport_hints = no_delay;
      info_subscriber = nh_.subscribe(options);
    }
    const image_transport::TransportHints hints(params_.transport, no_delay, ros::NodeHandle(params_.parameters),
                                                kNoParameter);
    subscription = ImageSubscription(nh_, *it, params_.topic, hints,
                                     [this](const sensor_msgs::ImageConstPtr& message) { onImage(message); });
  }
  catch (...)
  {
    close();
    throw;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!open_) return;  // it was closed meanwhile
  std::swap(subscription, subscription_);
  std::swap(info_subscriber, info_subscriber_);
}

void LatestImageSubscriber::close()
{
  ImageSubscription subscription;
  ros::Subscriber info_subscriber;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!open_) return;
    open_ = false;
    std::swap(subscription, subscription_);
    std::swap(info_subscriber, info_subscriber_);
    images_.clear();
    infos_.clear();
    statistics_->setIdle();
  }
  subscription.shutdown();  // waits for a running callback, which needs the lock
  info_subscriber.shutdown();
}

std::uint32_t LatestImageSubscriber::publishers() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return open_ ? subscription_.publishers() : 0;
}

void LatestImageSubscriber::onImage(const sensor_msgs::ImageConstPtr& message)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!open_) return;
  images_.push_back(message);
  if (images_.size() <= (params_.camera_info_topic.empty() ? 1 : kMaxUnpaired)) return;
  images_.pop_front();
  if (!params_.camera_info_topic.empty() && throttle_.due())
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

std::optional<ReceivedImage> LatestImageSubscriber::takeNewest()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto image = images_.rbegin(); image != images_.rend(); ++image)
  {
    ReceivedImage received;
    received.message = *image;
    if (!params_.camera_info_topic.empty())
    {
      received.camera_info = infoOf(**image);
      if (!received.camera_info) continue;  // its camera_info may still come
    }
    images_.erase(images_.begin(), image.base());  // with all older ones
    return received;
  }
  return std::nullopt;
}

std::optional<ReceivedImage> LatestImageSubscriber::take()
{
  std::optional<ReceivedImage> received = takeNewest();
  if (!received) return std::nullopt;
  const sensor_msgs::ImageConstPtr message = received->message;
  received->header = message->header;
  taken_stamp_ = message->header.stamp;
  taken_at_ = FrameStatistics::Clock::now();
  statistics_->received(message->header.seq);
  try
  {
    const bool unconverted = params_.encoding.empty();
    received->encoding = unconverted ? message->encoding : params_.encoding;
    received->pixels = unconverted ? viewAnyPixels(*message) : convertPixels(*message, params_.encoding);
    if (received->pixels.u != nullptr) received->message.reset();
  }
  catch (const std::exception& e)
  {
    refuse(*message, e.what());
    return std::nullopt;
  }
  return received;
}

void LatestImageSubscriber::finished()
{
  statistics_->published(taken_at_, taken_stamp_);
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
