#include "lazy_outputs.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace robot_vision
{

LazyOutputs::LazyOutputs(const ros::NodeHandle& pnh, std::function<void()> on_change)
  : pnh_(pnh), it_(pnh), on_change_(std::move(on_change))
{
}

void LazyOutputs::advertiseImages(const std::string& name)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (outputs_.count(name) > 0) return;
  }
  const auto on_connection = [this](const image_transport::SingleSubscriberPublisher&) { on_change_(); };
  const AdvertisingLock advertising;
  const auto images = std::make_shared<ImageTopic>();
  images->publisher = it_.advertise(name, kQueueSize, on_connection, on_connection);
  images->shared = SharedTopic::of(images->publisher.getTopic());
  images->maker.addTopic(images->shared);
  add(name, {[images] { return images->publisher.getNumSubscribers() > 0; }, nullptr, images});
}

void LazyOutputs::withdraw(const std::string& name)
{
  const AdvertisingLock advertising;
  Output removed;  // outlives the lock, because its end waits for callbacks that ask for it
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = outputs_.find(name);
  if (found == outputs_.end()) return;
  removed = std::move(found->second);
  outputs_.erase(found);
}

bool LazyOutputs::areWanted() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::any_of(outputs_.begin(), outputs_.end(), [](const auto& entry) { return entry.second.is_wanted(); });
}

bool LazyOutputs::isWanted(const std::string& name) const
{
  return output(name).is_wanted();
}

std::uint64_t LazyOutputs::unshared() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto add = [](std::uint64_t sum, const auto& entry)
  { return sum + (entry.second.images ? entry.second.images->shared->dropped() : 0); };
  return std::accumulate(outputs_.begin(), outputs_.end(), std::uint64_t{0}, add);
}

void LazyOutputs::publishImage(const std::string& name, const std_msgs::Header& header, const ImageMaker::Fill& fill)
{
  const std::shared_ptr<ImageTopic> images = output(name).images;  // stays while it is used
  const sensor_msgs::ImagePtr message = images->maker.make(fill);
  message->header = header;
  publish(*images, message);
}

void LazyOutputs::publishImage(const std::string& name, const sensor_msgs::ImagePtr& message)
{
  publish(*output(name).images, message);
}

void LazyOutputs::publish(ImageTopic& images, const sensor_msgs::ImagePtr& message)
{
  message->header.seq = ++images.published;
  images.publisher.publish(sensor_msgs::ImageConstPtr(message));
}

void LazyOutputs::add(const std::string& name, Output output)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  outputs_[name] = std::move(output);
}

LazyOutputs::Output LazyOutputs::output(const std::string& name) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return outputs_.at(name);
}

}  // namespace robot_vision
