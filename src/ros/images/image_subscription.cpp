#include "image_subscription.hpp"

#include "bounded_reading.hpp"
#include "image_message.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint32_t kQueueSize = 1;  // so that after a slow frame the newest is next

}  // namespace

ImageSubscription::ImageSubscription(ros::NodeHandle nh, image_transport::ImageTransport& it, const std::string& topic,
                                     const image_transport::TransportHints& hints, const Callback& callback)
{
  if (hints.getTransport() != "raw")
  {
    // The plugin subscribes to `image/compressed`, to which a remapping of `image` would not apply.
    other_ = it.subscribe(nh.resolveName(topic), kQueueSize, callback, ros::VoidPtr(), hints);
    return;
  }
  ros::SubscribeOptions options =
      boundedOptions<sensor_msgs::Image>(topic, kQueueSize, callback, [pool = ImagePool()] { return pool.take(); });
  options.transport_hints = hints.getRosHints();
  raw_ = nh.subscribe(options);
}

void ImageSubscription::shutdown()
{
  raw_.shutdown();
  other_.shutdown();
}

}  // namespace robot_vision
