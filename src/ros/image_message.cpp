#include "image_message.hpp"

#include <boost/make_shared.hpp>

#include <atomic>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "robot_vision/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kPooled = 4;  // one being filled, one queued, two held by slow subscribers

bool isLittleEndianHost()
{
  const std::uint16_t one = 1;
  return *reinterpret_cast<const std::uint8_t*>(&one) == 1;
}

cv::Mat swapBytes(const cv::Mat& image)
{
  const cv::Mat bytes(image.rows, image.cols, CV_8UC2, image.data, image.step);
  cv::Mat swapped(image.size(), image.type());
  cv::Mat swapped_bytes(swapped.rows, swapped.cols, CV_8UC2, swapped.data, swapped.step);
  const int order[] = {0, 1, 1, 0};
  cv::mixChannels(&bytes, 1, &swapped_bytes, 1, order, 2);
  return swapped;
}

void checkLayout(const sensor_msgs::Image& message, std::uint64_t pixel_bytes)
{
  const auto refuse = [](const std::string& why) { throw std::invalid_argument(why); };
  constexpr auto kLargest = static_cast<std::uint32_t>(std::numeric_limits<int>::max());
  if (message.width == 0 || message.height == 0) refuse("the picture has no pixels");
  if (message.width > kLargest || message.height > kLargest) refuse("the size is beyond any picture");
  const std::uint64_t row_bytes = message.width * pixel_bytes;
  if (message.step < row_bytes)
    refuse("step is " + std::to_string(message.step) + ", must be at least " + std::to_string(row_bytes));
  const std::uint64_t bytes = std::uint64_t{message.step} * message.height;
  if (message.data.size() != bytes)
    refuse("data has " + std::to_string(message.data.size()) + " bytes, step * height is " + std::to_string(bytes));
  if (message.is_bigendian > 1) refuse("is_bigendian is " + std::to_string(message.is_bigendian) + ", must be 0 or 1");
}

}  // namespace

cv::Mat viewPixels(const sensor_msgs::Image& message)
{
  if (message.encoding == "jpeg" || message.encoding == "nv12")
    throw std::invalid_argument("encoding '" + message.encoding + "' is not one of sensor_msgs/Image");
  const int type = matType(message.encoding);
  checkLayout(message, static_cast<std::uint64_t>(CV_ELEM_SIZE(type)));
  auto* data = const_cast<std::uint8_t*>(message.data.data());
  const cv::Mat pixels(static_cast<int>(message.height), static_cast<int>(message.width), type, data, message.step);
  checkPixels(pixels, message.encoding);
  const bool other_order = (message.is_bigendian == 0) != isLittleEndianHost();
  return pixels.depth() == CV_16U && other_order ? swapBytes(pixels) : pixels;
}

sensor_msgs::ImagePtr ImagePool::take(cv::Size size, const std::string& encoding)
{
  sensor_msgs::ImagePtr free;
  for (const sensor_msgs::ImagePtr& message : messages_)
    if (message.use_count() == 1) free = message;
  if (free)
  {
    std::atomic_thread_fence(std::memory_order_acquire);  // after the last reader's release in another thread
  }
  else
  {
    free = boost::make_shared<sensor_msgs::Image>();
    if (messages_.size() < kPooled) messages_.push_back(free);
  }
  free->encoding = encoding;
  free->width = static_cast<std::uint32_t>(size.width);
  free->height = static_cast<std::uint32_t>(size.height);
  free->step = static_cast<std::uint32_t>(size.width * CV_ELEM_SIZE(matType(encoding)));
  free->is_bigendian = isLittleEndianHost() ? 0 : 1;
  free->data.resize(std::size_t{free->step} * free->height);
  return free;
}

cv::Mat writablePixels(sensor_msgs::Image& message)
{
  return {static_cast<int>(message.height), static_cast<int>(message.width), matType(message.encoding),
          message.data.data(), message.step};
}

}  // namespace robot_vision
