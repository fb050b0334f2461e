#pragma once

#include <robot_vision/ShmImage.h>
#include <sensor_msgs/Image.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "robot_vision/common/throttle.hpp"
#include "ros/shared_memory/slot_writer.hpp"

namespace robot_vision
{

/// What this process shares with the readers of one topic of images: the transport shm publishes it, and those that
/// make the topic's images ask whether they should stand in shared memory from the start, so that nothing is copied.
/// Thread-safe.
class SharedTopic
{
public:
  /// The one object of this process for a topic (absolute, without /shm), while anybody holds it.
  static std::shared_ptr<SharedTopic> of(const std::string& topic);

  explicit SharedTopic(std::string topic);

  const std::string& topic() const { return topic_; }

  /// Whether a publisher has readers.
  using IsRead = std::function<bool()>;

  /// Adds a publisher of shm, for as long as the function exists.
  void addPublisher(const std::shared_ptr<IsRead>& is_read);
  /// Whether anybody reads the topic over shm.
  bool isRead() const;
  /// Gives the memory back if the last reader has gone; frames that readers hold stay as they are.
  void freeUnread();

  /// A message whose data has that many bytes of shared memory; the rest is empty. Null if nobody reads over shm, if
  /// readers hold all the memory there may be, or where a std::vector cannot stand on such memory.
  sensor_msgs::ImagePtr make(std::size_t bytes);

  /// A published image and what keeps its pixels from being overwritten.
  struct Published
  {
    ShmImage message;
    std::shared_ptr<WritableSlot> slot;  // null for an image without pixels
  };

  /// Makes an image readable for others, without a copy if it stands in shared memory. `pixels` are those of the image,
  /// whose own data is not looked at. Returns false, and counts the frame as dropped, if there is no memory left.
  bool publish(const sensor_msgs::Image& image, const std::uint8_t* pixels, std::size_t bytes, Published& published);

  /// The frames that were not published over shm, because readers hold all the memory that there may be.
  std::uint64_t dropped() const { return dropped_; }

private:
  std::string topic_;
  mutable std::mutex mutex_;  // guards publishers_
  std::vector<std::weak_ptr<IsRead>> publishers_;
  std::atomic<std::uint64_t> dropped_{0};
  Throttle unpublished_;
  SlotWriter writer_;
};

/// The sum of SharedTopic::dropped().
std::uint64_t droppedOf(const std::vector<std::shared_ptr<SharedTopic>>& topics);

}  // namespace robot_vision
