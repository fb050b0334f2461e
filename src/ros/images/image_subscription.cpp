#include "image_subscription.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "bounded_reading.hpp"
#include "image_message.hpp"
#include "robot_vision/common/range.hpp"
#include "ros/params/params.hpp"
#include "subscribing_lock.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint32_t kQueueSize = 1;  // so that after a slow frame the newest is next

}  // namespace

void requireTransport(const image_transport::ImageTransport& it, const std::string& transport,
                      const std::string& parameter)
{
  if (transport == kAutoTransport) return;
  std::vector<std::string> known = {kAutoTransport};
  for (std::string name : it.getLoadableTransports())
  {
    name.erase(0, name.find('/') + 1);  // the names are like image_transport/raw
    if (name == transport) return;
    known.push_back(name);
  }
  require(false, parameter, "'" + transport + "'", "one that is installed: " + joined(known));
}

image_transport::TransportHints readTransport(const image_transport::ImageTransport& it, const ros::NodeHandle& pnh,
                                              const std::string& parameter)
{
  std::string transport;
  readParam(pnh, parameter, transport);  // refuses another type, which the hints would take for no parameter
  // Without this option small packets would wait for each other.
  const image_transport::TransportHints hints(kAutoTransport, ros::TransportHints().tcpNoDelay(), pnh, parameter);
  requireTransport(it, hints.getTransport(), parameter);
  return hints;
}

ImageSubscription::ImageSubscription(ros::NodeHandle nh, image_transport::ImageTransport& it, const std::string& topic,
                                     const image_transport::TransportHints& hints, const Callback& callback)
{
  if (hints.getTransport() == kAutoTransport)
  {
    auto_ = std::make_shared<AutoSubscription>(nh, AutoSubscription::Params{topic, kQueueSize, hints.getRosHints(), {}},
                                               callback);
    return;
  }
  const SubscribingLock subscribing;
  if (hints.getTransport() != "raw")
  {
    // Plugins subscribe to `image/compressed`, to which a remapping of `image` would not apply; that of shm subscribes
    // to `image`, too, which would be remapped twice.
    const std::string base = hints.getTransport() == "shm" ? topic : nh.resolveName(topic);
    other_ = it.subscribe(base, kQueueSize, callback, ros::VoidPtr(), hints);
    return;
  }
  ros::SubscribeOptions options =
      boundedOptions<sensor_msgs::Image>(topic, kQueueSize, callback, [pool = ImagePool()] { return pool.take(); });
  options.transport_hints = hints.getRosHints();
  raw_ = nh.subscribe(options);
}

std::string ImageSubscription::topic() const
{
  return auto_ ? auto_->topic() : raw_ ? raw_.getTopic() : other_.getTopic();
}

std::uint32_t ImageSubscription::publishers() const
{
  return auto_ ? auto_->publishers() : raw_ ? raw_.getNumPublishers() : other_.getNumPublishers();
}

void ImageSubscription::shutdown()
{
  if (auto_) auto_->shutdown();  // its callback may use this meanwhile
  auto_.reset();
  if (raw_) endSubscription(raw_);
  if (!other_) return;
  std::optional<SubscribingLock> subscribing;
  // That of shm waits for its review, which may wait for the lock, and it holds the lock by itself.
  if (other_.getTransport() != "shm") subscribing.emplace();
  other_.shutdown();
}

void ImageSubscription::swap(ImageSubscription& other)
{
  std::swap(auto_, other.auto_);
  std::swap(raw_, other.raw_);
  std::swap(other_, other.other_);
}

}  // namespace robot_vision
