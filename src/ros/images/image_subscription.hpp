#pragma once

#include <image_transport/image_transport.h>
#include <sensor_msgs/Image.h>

#include <boost/function.hpp>
#include <cstdint>
#include <string>

namespace robot_vision
{

/// The newest picture of a topic, over the image_transport of the hints. Raw ones come in messages that are reused when
/// nobody holds them any more: those that image_transport makes are new for every picture, and zeroed before its pixels
/// are copied into them.
class ImageSubscription
{
public:
  using Callback = boost::function<void(const sensor_msgs::ImageConstPtr&)>;

  ImageSubscription() = default;

  /// Both `nh` and `it` bring the queue that `callback` is called through.
  ImageSubscription(ros::NodeHandle nh, image_transport::ImageTransport& it, const std::string& topic,
                    const image_transport::TransportHints& hints, const Callback& callback);

  explicit operator bool() const { return raw_ || other_; }
  std::string topic() const { return raw_ ? raw_.getTopic() : other_.getTopic(); }
  std::uint32_t publishers() const { return raw_ ? raw_.getNumPublishers() : other_.getNumPublishers(); }

  /// Unsubscribes; waits for a callback under way.
  void shutdown();

private:
  ros::Subscriber raw_;
  image_transport::Subscriber other_;
};

}  // namespace robot_vision
