#pragma once

#include <image_transport/simple_publisher_plugin.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <memory>
#include <string>

#include "robot_vision/common/throttle.hpp"
#include "ros/images/image_message.hpp"
#include "ros/images/newest_worker.hpp"
#include "ros/transports/transport_settings.hpp"

namespace robot_vision
{

/// A publisher plugin with live settings in its topic's namespace. Images are sent in another thread, the newest next,
/// so that publish() does not wait; images that come too fast are dropped. An image that cannot be sent is refused with
/// a throttled error. The destructor of a derived class must call shutdown(), because users need not do so, and until
/// then the other thread calls send().
template <class Message, class Config, class Params>
class TransportPublisher : public image_transport::SimplePublisherPlugin<Message>
{
public:
  void publish(const sensor_msgs::ImageConstPtr& message) const override
  {
    worker_.post(
        [this, message]
        {
          if (this->getNumSubscribers() == 0) return;  // the subscribers have gone while the image waited
          publish(*message, [this](const Message& sent) { this->getPublisher().publish(sent); });
        });
  }

  void publish(const sensor_msgs::Image& message) const override
  {
    publish(sensor_msgs::ImageConstPtr(boost::make_shared<sensor_msgs::Image>(message)));
  }

  /// Waits for the image that is being sent; later ones are dropped.
  void shutdown() override
  {
    worker_.stop();
    Plugin::shutdown();
  }

protected:
  using Plugin = image_transport::SimplePublisherPlugin<Message>;
  using Settings = TransportSettings<Config, Params>;
  using PublishFn = typename Plugin::PublishFn;

  explicit TransportPublisher(typename Settings::ToParams to_params) : to_params_(to_params) {}

  /// Sends an image; throws if that is not possible. Two threads may call it at once, because a new subscriber may be
  /// sent an image separately.
  virtual void send(const sensor_msgs::Image& message, const Params& params, const PublishFn& publish_fn) const = 0;

  /// Logs once why nothing is sent of such images. That is no error: recorders subscribe to all transports of a topic.
  void leaveEmpty(const std::string& reason) const
  {
    if (!left_empty_.exchange(true)) ROS_INFO("%s stays empty: %s", this->getTopic().c_str(), reason.c_str());
  }

  void advertiseImpl(ros::NodeHandle& nh, const std::string& base_topic, std::uint32_t queue_size,
                     const image_transport::SubscriberStatusCallback& on_connect,
                     const image_transport::SubscriberStatusCallback& on_disconnect, const ros::VoidPtr& tracked_object,
                     bool latch) override
  {
    settings_ = std::make_unique<Settings>(ros::NodeHandle(this->getTopicToAdvertise(base_topic)), to_params_);
    Plugin::advertiseImpl(nh, base_topic, queue_size, on_connect, on_disconnect, tracked_object, latch);
  }

private:
  void publish(const sensor_msgs::Image& message, const PublishFn& publish_fn) const final
  try
  {
    send(message, settings_->params(), publish_fn);
  }
  catch (const std::exception& e)
  {
    if (refused_.due()) ROS_ERROR("%s", describeRefusal(message, this->getTopic(), e.what()).c_str());
  }

  typename Settings::ToParams to_params_;
  std::unique_ptr<Settings> settings_;
  mutable Throttle refused_;
  mutable std::atomic<bool> left_empty_{false};
  mutable NewestWorker worker_;
};

}  // namespace robot_vision
