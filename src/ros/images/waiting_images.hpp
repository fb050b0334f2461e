#pragma once

#include <cstddef>

namespace robot_vision
{

/// The most bytes of images of one topic that wait for something that belongs to them; one image may be larger.
constexpr std::size_t kMaxWaitingBytes = std::size_t{1} << 27;

/// Drops the oldest of the images that wait while they are more than `max_count`, or too many bytes. `image_of` gives
/// the sensor_msgs::Image of one of them. Returns whether any were dropped.
template <class Waiting, class ImageOf>
bool dropOldest(Waiting& waiting, std::size_t max_count, const ImageOf& image_of)
{
  std::size_t bytes = 0;
  for (const auto& one : waiting)
    bytes += image_of(one).data.size();
  const std::size_t before = waiting.size();
  while (waiting.size() > max_count || (waiting.size() > 1 && bytes > kMaxWaitingBytes))
  {
    bytes -= image_of(waiting.front()).data.size();
    waiting.pop_front();
  }
  return waiting.size() < before;
}

}  // namespace robot_vision
