#pragma once

#include <image_transport/simple_publisher_plugin.h>

#include <memory>
#include <string>

#include "ros/image_message.hpp"
#include "ros/throttle.hpp"
#include "ros/transport_settings.hpp"

namespace robot_vision
{

/// A publisher plugin whose settings are live in its topic's namespace. A picture that cannot be sent is refused with a
/// throttled error.
template <class Message, class Config, class Params>
class TransportPublisher : public image_transport::SimplePublisherPlugin<Message>
{
protected:
  using Plugin = image_transport::SimplePublisherPlugin<Message>;
  using Settings = TransportSettings<Config, Params>;
  using PublishFn = typename Plugin::PublishFn;

  explicit TransportPublisher(typename Settings::ToParams to_params) : to_params_(to_params) {}

  /// Throws for a picture that cannot be sent.
  virtual void send(const sensor_msgs::Image& message, const Params& params, const PublishFn& publish_fn) const = 0;

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
};

}  // namespace robot_vision
