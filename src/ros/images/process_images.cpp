#include "process_images.hpp"

#include <algorithm>

namespace robot_vision
{
namespace
{

// TransportHints lets the parameter of this name override the given transport; there cannot be one of this name.
constexpr const char* kNoParameter = "image_transport/none";

}  // namespace

ProcessImages::ProcessImages(std::string topic, std::string transport)
  : topic_(std::move(topic)), transport_(std::move(transport)), queue_(Wake{this})
{
  nh_.setCallbackQueue(&queue_);
  gate_.guard(nh_);
}

void ProcessImages::add(Listener& listener, const std::string& parameters)
{
  bool is_late = false;
  {
    const std::lock_guard<std::mutex> lock(listeners_mutex_);
    listeners_.push_back(&listener);
    is_late = has_come_;
  }
  const std::lock_guard<std::mutex> subscribing(subscribing_);
  if (is_late)
    catchUp(listener, parameters);
  else
    subscribe(parameters);
}

void ProcessImages::remove(Listener& listener)
{
  {
    const std::lock_guard<std::mutex> lock(listeners_mutex_);
    listeners_.erase(std::remove(listeners_.begin(), listeners_.end(), &listener), listeners_.end());
  }
  endLate([&listener](const Late& late) { return late.listener == &listener; });
}

ImageSubscription ProcessImages::subscription(image_transport::ImageTransport& it, const std::string& parameters,
                                              const ImageSubscription::Callback& callback)
{
  // Without the option small packets would wait for each other.
  const image_transport::TransportHints hints(transport_, ros::TransportHints().tcpNoDelay(),
                                              ros::NodeHandle(parameters), kNoParameter);
  return {nh_, it, topic_, hints, callback};
}

/// The subscriptions of this function and the next are made without the lock, because that calls the master, for which
/// close() must not wait.
void ProcessImages::subscribe(const std::string& parameters)
{
  Transports it;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_ || subscribed_) return;
    it_ = it = std::make_shared<image_transport::ImageTransport>(nh_);
  }
  ImageSubscription made =
      subscription(*it, parameters, [this](const sensor_msgs::ImageConstPtr& message) { onImage(message); });
  const std::lock_guard<std::mutex> lock(mutex_);
  if (closed_) return;
  std::swap(made, subscription_);
  subscribed_ = true;
}

void ProcessImages::catchUp(Listener& listener, const std::string& parameters)
{
  Transports it;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return;
    it = it_;
  }
  const auto late = std::make_shared<Late>(Late{&listener, false, {}});
  {
    const std::lock_guard<std::mutex> lock(listeners_mutex_);
    if (std::count(listeners_.begin(), listeners_.end(), &listener) == 0) return;  // it was removed meanwhile
    late_.push_back(late);
  }
  ImageSubscription made =
      subscription(*it, parameters, [this, late = late.get()](const auto& message) { onMissedImage(*late, message); });
  const std::lock_guard<std::mutex> lock(listeners_mutex_);
  if (std::count(late_.begin(), late_.end(), late) != 0) std::swap(made, late->subscription);
}

void ProcessImages::endLate(const std::function<bool(const Late&)>& ends)
{
  std::vector<std::shared_ptr<Late>> ended;  // which wait for their callbacks, so not under the lock
  const std::lock_guard<std::mutex> lock(listeners_mutex_);
  const auto first = std::partition(late_.begin(), late_.end(), [&ends](const auto& late) { return !ends(*late); });
  ended.assign(std::make_move_iterator(first), std::make_move_iterator(late_.end()));
  late_.erase(first, late_.end());
}

void ProcessImages::receive()
{
  const std::lock_guard<std::mutex> lock(receiving_);
  queue_.callAvailable(ros::WallDuration(0));
  endLate([](const Late& late) { return late.over; });
}

std::uint32_t ProcessImages::publishers() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return subscribed_ ? subscription_.publishers() : 0;
}

void ProcessImages::close()
{
  ImageSubscription subscription;
  std::shared_ptr<image_transport::ImageTransport> it;  // outlives the subscription
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return;
    closed_ = true;
    subscribed_ = false;
    std::swap(it, it_);
    std::swap(subscription, subscription_);
  }
  gate_.close();
  endLate([](const Late&) { return true; });
  subscription.shutdown();
  subscription = {};
}

void ProcessImages::onComing()
{
  const std::lock_guard<std::mutex> lock(listeners_mutex_);
  for (Listener* listener : listeners_)
    listener->onComing();
}

void ProcessImages::onImage(const sensor_msgs::ImageConstPtr& message)
{
  const auto frame = std::make_shared<ProcessFrame>(message, pool_);
  const std::lock_guard<std::mutex> lock(listeners_mutex_);
  has_come_ = true;
  for (Listener* listener : listeners_)
    listener->onFrame(frame);
  for (const auto& late : late_)
    late->over = true;
}

void ProcessImages::onMissedImage(const Late& late, const sensor_msgs::ImageConstPtr& message)
{
  const std::lock_guard<std::mutex> lock(listeners_mutex_);
  if (!late.over) late.listener->onFrame(std::make_shared<ProcessFrame>(message, pool_));
}

std::shared_ptr<ProcessImages> ProcessSubscriptions::take(const std::string& topic, const std::string& transport)
{
  const auto made = std::make_shared<ProcessImages>(topic, transport);  // without the lock, as roscpp has its own
  const std::lock_guard<std::mutex> lock(mutex_);
  if (closed_) return nullptr;
  for (auto known = images_.begin(); known != images_.end();)  // so that a process that has seen many does not grow
    known = known->second.expired() ? images_.erase(known) : std::next(known);
  std::weak_ptr<ProcessImages>& known = images_[{topic, transport}];
  std::shared_ptr<ProcessImages> images = known.lock();
  if (!images) known = images = made;
  return images;
}

void ProcessSubscriptions::close()
{
  std::vector<std::shared_ptr<ProcessImages>> open;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    for (const auto& [key, images] : images_)
      if (auto alive = images.lock()) open.push_back(std::move(alive));
  }
  for (const auto& images : open)
    images->close();
}

}  // namespace robot_vision
