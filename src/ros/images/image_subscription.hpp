#pragma once

#include <image_transport/image_transport.h>
#include <sensor_msgs/Image.h>

#include <boost/function.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "auto_subscription.hpp"

namespace robot_vision
{

/// The transport that is none of image_transport's: shared memory where all publishers offer it, else raw, see
/// AutoSubscription. The default of this package's nodes.
constexpr const char* kAutoTransport = "auto";

/// Throws std::invalid_argument naming the parameter and the installed transports if `transport` ("raw", "compressed")
/// is not among them, and not "auto".
void requireTransport(const image_transport::ImageTransport& it, const std::string& transport,
                      const std::string& parameter = "image_transport");

/// The hints for subscriptions over the transport that a parameter of `pnh` names, "auto" without it. To be read at
/// start, because later what cannot be loaded would be found by the first subscriber. Throws as requireTransport().
image_transport::TransportHints readTransport(const image_transport::ImageTransport& it, const ros::NodeHandle& pnh,
                                              const std::string& parameter = "image_transport");

/// Subscribes to the newest image of a topic over the image_transport of the hints. Raw images come in messages from a
/// pool: image_transport would allocate a new message for each image and set it to zero before it copies the pixels.
/// Its end is a shutdown().
class ImageSubscription
{
public:
  using Callback = boost::function<void(const sensor_msgs::ImageConstPtr&)>;

  ImageSubscription() = default;
  ~ImageSubscription() { shutdown(); }
  ImageSubscription(ImageSubscription&& other) noexcept { swap(other); }
  ImageSubscription& operator=(ImageSubscription other) noexcept
  {
    swap(other);
    return *this;
  }

  /// Both `nh` and `it` must use the queue through which `callback` is to be called.
  ImageSubscription(ros::NodeHandle nh, image_transport::ImageTransport& it, const std::string& topic,
                    const image_transport::TransportHints& hints, const Callback& callback);

  explicit operator bool() const { return auto_ || raw_ || other_; }
  std::string topic() const;
  std::uint32_t publishers() const;

  /// Unsubscribes and waits for a running callback.
  void shutdown();

private:
  void swap(ImageSubscription& other);  // roscpp's are not moved: the old one would end what both have

  std::shared_ptr<AutoSubscription> auto_;
  ros::Subscriber raw_;
  image_transport::Subscriber other_;
};

}  // namespace robot_vision
