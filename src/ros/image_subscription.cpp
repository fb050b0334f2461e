#include "image_subscription.hpp"

#include <memory>
#include <mutex>

#include "image_message.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint32_t kQueue = 1;  // after a slow frame the newest is next

/// A pool for the threads of all who subscribe to a topic in this process: one of them makes a message for the others.
struct SharedPool
{
  sensor_msgs::ImagePtr take()
  {
    const std::lock_guard<std::mutex> lock(mutex);
    return pool.take();
  }

  std::mutex mutex;
  ImagePool pool;
};

}  // namespace

ImageSubscription::ImageSubscription(ros::NodeHandle nh, image_transport::ImageTransport& it, const std::string& topic,
                                     const image_transport::TransportHints& hints, const Callback& callback)
{
  if (hints.getTransport() != "raw")
  {
    // A remapping of `image` is none of `image/compressed`, which is what the plugin subscribes to.
    other_ = it.subscribe(nh.resolveName(topic), kQueue, callback, ros::VoidPtr(), hints);
    return;
  }
  const auto pool = std::make_shared<SharedPool>();
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const sensor_msgs::ImageConstPtr&>(topic, kQueue, callback,
                                                                    [pool] { return pool->take(); });
  options.transport_hints = hints.getRosHints();
  raw_ = nh.subscribe(options);
}

void ImageSubscription::shutdown()
{
  raw_.shutdown();
  other_.shutdown();
}

}  // namespace robot_vision
