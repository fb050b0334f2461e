#include "shared_topic.hpp"

#include <ros/console.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <cstring>
#include <numeric>
#include <utility>

#include "image_description.hpp"
#include "robot_vision/common/shared_instance.hpp"
#include "ros/shared_memory/adopted_vector.hpp"

namespace robot_vision
{
namespace
{

/// A message in a slot; the members end in the reverse order.
struct SlotImage
{
  explicit SlotImage(std::shared_ptr<WritableSlot> in)
    : slot(std::move(in)), pixels(message.data, slot->data(), slot->bytes())
  {
  }

  std::shared_ptr<WritableSlot> slot;
  sensor_msgs::Image message;
  AdoptedVector pixels;
};

void setAddress(const SlotAddress& address, ShmImage& message)
{
  message.boot_id = address.boot_id;
  message.socket = address.socket;
  message.publisher = address.publisher;
  message.slot = address.slot;
  message.memory = address.memory;
  message.generation = address.generation;
  message.bytes = address.bytes;
}

}  // namespace

std::shared_ptr<SharedTopic> SharedTopic::of(const std::string& topic)
{
  return sharedInstance<SharedTopic>(topic);
}

SharedTopic::SharedTopic(std::string topic) : topic_(std::move(topic))
{
}

void SharedTopic::addPublisher(const std::shared_ptr<IsRead>& is_read)
{
  const auto expired = [](const std::weak_ptr<IsRead>& one) { return one.expired(); };
  const std::lock_guard<std::mutex> lock(mutex_);
  publishers_.erase(std::remove_if(publishers_.begin(), publishers_.end(), expired), publishers_.end());
  publishers_.push_back(is_read);
}

bool SharedTopic::isRead() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::any_of(publishers_.begin(), publishers_.end(),
                     [](const std::weak_ptr<IsRead>& one)
                     {
                       const std::shared_ptr<IsRead> publisher = one.lock();
                       return publisher && (*publisher)();
                     });
}

void SharedTopic::freeUnread()
{
  if (!isRead()) writer_.rest();
}

sensor_msgs::ImagePtr SharedTopic::make(std::size_t bytes)
{
  if (AdoptedVector::kCopies || !isRead() || bytes == 0) return nullptr;
  std::shared_ptr<WritableSlot> slot = writer_.take(bytes);
  if (!slot) return nullptr;
  const auto image = boost::make_shared<SlotImage>(std::move(slot));
  return {image, &image->message};
}

bool SharedTopic::publish(const sensor_msgs::Image& image, const std::uint8_t* pixels, std::size_t bytes,
                          Published& published)
{
  if (bytes > 0)
  {
    published.slot = findSlot(pixels);
    if (!published.slot || published.slot->bytes() != bytes)  // which may be a part of the image in there
    {
      published.slot = writer_.take(bytes);
      if (published.slot) std::memcpy(published.slot->data(), pixels, bytes);
    }
    if (!published.slot)
    {
      ++dropped_;
      if (unpublished_.due())
        ROS_WARN("%s: a frame is not published over shm: %s", topic_.c_str(), writer_.counts().reason.c_str());
      return false;
    }
    setAddress(published.slot->publish(), published.message);
  }
  copyDescription(image, published.message);
  return true;
}

std::uint64_t droppedOf(const std::vector<std::shared_ptr<SharedTopic>>& topics)
{
  const auto add = [](std::uint64_t sum, const std::shared_ptr<SharedTopic>& topic) { return sum + topic->dropped(); };
  return std::accumulate(topics.begin(), topics.end(), std::uint64_t{0}, add);
}

}  // namespace robot_vision
