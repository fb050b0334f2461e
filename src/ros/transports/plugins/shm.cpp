#include <image_transport/simple_publisher_plugin.h>
#include <image_transport/subscriber_plugin.h>
#include <robot_vision/ShmImage.h>

#include <memory>
#include <mutex>
#include <pluginlib/class_list_macros.hpp>
#include <string>

#include "ros/images/auto_subscription.hpp"
#include "ros/images/shared_topic.hpp"

namespace robot_vision
{

/// Publishes where images stand in shared memory. They are copied there, unless they are there already.
class ShmPublisher : public image_transport::SimplePublisherPlugin<ShmImage>
{
public:
  std::string getTransportName() const override { return "shm"; }

  void publish(const sensor_msgs::ImageConstPtr& message) const override { publish(*message); }
  void publish(const sensor_msgs::Image& message) const override
  {
    shareWithAll(message, message.data.data(), message.data.size());
  }
  void publish(const sensor_msgs::Image& message, const std::uint8_t* data) const override
  {
    shareWithAll(message, data, std::size_t{message.step} * message.height);
  }

  void shutdown() override
  {
    is_read_.reset();
    Plugin::shutdown();
    const std::lock_guard<std::mutex> lock(mutex_);
    latched_.reset();
  }

private:
  using Plugin = image_transport::SimplePublisherPlugin<ShmImage>;

  void advertiseImpl(ros::NodeHandle& nh, const std::string& base_topic, std::uint32_t queue_size,
                     const image_transport::SubscriberStatusCallback& on_connect,
                     const image_transport::SubscriberStatusCallback& on_disconnect, const ros::VoidPtr& tracked_object,
                     bool latch) override
  {
    latch_ = latch;
    topic_ = SharedTopic::of(nh.resolveName(base_topic, /*remap=*/false));  // image_transport has remapped it
    Plugin::advertiseImpl(nh, base_topic, queue_size, on_connect, on_disconnect, tracked_object, latch);
    is_read_ = std::make_shared<SharedTopic::IsRead>([publisher = getPublisher()]
                                                     { return publisher.getNumSubscribers() > 0; });
    topic_->addPublisher(is_read_);
  }

  void disconnectCallback(const ros::SingleSubscriberPublisher& /*subscriber*/) override { topic_->freeUnread(); }

  /// For one new subscriber.
  void publish(const sensor_msgs::Image& message, const PublishFn& send) const override
  {
    SharedTopic::Published published;
    if (topic_->publish(message, message.data.data(), message.data.size(), published)) send(published.message);
  }

  void shareWithAll(const sensor_msgs::Image& message, const std::uint8_t* pixels, std::size_t bytes) const
  {
    SharedTopic::Published published;
    if (!topic_->publish(message, pixels, bytes, published)) return;
    if (!latch_) return getPublisher().publish(published.message);
    const std::lock_guard<std::mutex> lock(mutex_);  // so that the slot is that of the message that roscpp keeps
    getPublisher().publish(published.message);
    std::swap(latched_, published.slot);
  }

  bool latch_ = false;
  std::shared_ptr<SharedTopic> topic_;
  std::shared_ptr<SharedTopic::IsRead> is_read_;
  mutable std::mutex mutex_;                       // guards latched_
  mutable std::shared_ptr<WritableSlot> latched_;  // what later subscribers are told of
};

/// Subscribes to "shm", and to raw where that cannot be had.
class ShmSubscriber : public image_transport::SubscriberPlugin
{
public:
  std::string getTransportName() const override { return "shm"; }
  std::string getTopic() const override { return subscription_ ? subscription_->topic() + "/shm" : ""; }
  std::uint32_t getNumPublishers() const override { return subscription_ ? subscription_->publishers() : 0; }
  void shutdown() override
  {
    if (subscription_) subscription_->shutdown();
  }

private:
  void subscribeImpl(ros::NodeHandle& nh, const std::string& base_topic, std::uint32_t queue_size,
                     const Callback& callback, const ros::VoidPtr& tracked_object,
                     const image_transport::TransportHints& hints) override
  {
    AutoSubscription::Params params;
    params.topic = base_topic;
    params.queue_size = queue_size;
    params.hints = hints.getRosHints();
    params.tracked_object = tracked_object;
    params.wants_shared = true;
    subscription_ = std::make_unique<AutoSubscription>(nh, params, callback);
  }

  std::unique_ptr<AutoSubscription> subscription_;
};

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::ShmPublisher, image_transport::PublisherPlugin)
PLUGINLIB_EXPORT_CLASS(robot_vision::ShmSubscriber, image_transport::SubscriberPlugin)
