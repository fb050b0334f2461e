#include "image_message.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "cv_bridge_calls.hpp"
#include "robot_vision/common/byte_order.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

cv::Mat swapBytes(const cv::Mat& image)
{
  cv::Mat swapped = image.clone();
  const std::size_t sample = image.elemSize1();
  for (int y = 0; y < swapped.rows; ++y)
  {
    std::uint8_t* const row = swapped.ptr(y);
    for (std::uint8_t* p = row; p != row + swapped.cols * swapped.elemSize(); p += sample)
      std::reverse(p, p + sample);
  }
  return swapped;
}

void checkLayout(const sensor_msgs::Image& message, int type)
{
  const auto pixel_bytes = static_cast<std::uint64_t>(CV_ELEM_SIZE(type));
  const auto refuse = [](const std::string& reason) { throw std::invalid_argument(reason); };
  constexpr auto kMaxSize = static_cast<std::uint32_t>(std::numeric_limits<int>::max());
  if (message.width == 0 || message.height == 0) refuse("the image has no pixels");
  if (message.width > kMaxSize || message.height > kMaxSize) refuse("the size is beyond any image");
  const std::uint64_t row_bytes = message.width * pixel_bytes;
  if (message.step < row_bytes)
    refuse("step is " + std::to_string(message.step) + ", must be at least " + std::to_string(row_bytes));
  if (message.step % CV_ELEM_SIZE1(type) != 0)
    refuse("step is " + std::to_string(message.step) + ", must be a multiple of " +
           std::to_string(CV_ELEM_SIZE1(type)));
  const std::uint64_t bytes = std::uint64_t{message.step} * message.height;
  if (message.data.size() != bytes)
    refuse("data has " + std::to_string(message.data.size()) + " bytes, step * height is " + std::to_string(bytes));
  if (message.is_bigendian > 1) refuse("is_bigendian is " + std::to_string(message.is_bigendian) + ", must be 0 or 1");
}

/// Checks a message's layout and gives its pixels in this machine's byte order.
cv::Mat view(const sensor_msgs::Image& message, int type)
{
  checkLayout(message, type);
  auto* data = const_cast<std::uint8_t*>(message.data.data());
  const cv::Mat pixels(static_cast<int>(message.height), static_cast<int>(message.width), type, data, message.step);
  const bool other_order = (message.is_bigendian == 0) != isLittleEndianHost();
  return pixels.elemSize1() > 1 && other_order ? swapBytes(pixels) : pixels;
}

}  // namespace

int anyMatType(const std::string& encoding)
{
  if (isMessageEncoding(encoding)) return matType(encoding);
  int type = 0;
  try
  {
    type = typeByCvBridge(encoding);
  }
  catch (const std::exception& e)
  {
    throw std::invalid_argument("encoding '" + printable(encoding) + "' cannot be used: " + printable(e.what()));
  }
  if (type == CV_MAT_TYPE(type)) return type;  // the types of 8UC0 and 8UC513 are not valid
  throw std::invalid_argument("encoding '" + printable(encoding) + "' has a number of channels that no image has");
}

cv::Mat viewPixels(const sensor_msgs::Image& message)
{
  if (isEncoding(message.encoding) && !isMessageEncoding(message.encoding))
    throw std::invalid_argument("encoding '" + printable(message.encoding) + "' is not one of sensor_msgs/Image");
  const cv::Mat pixels = view(message, matType(message.encoding));
  checkPixels(pixels, message.encoding);
  return pixels;
}

cv::Mat viewAnyPixels(const sensor_msgs::Image& message)
{
  return isMessageEncoding(message.encoding) ? viewPixels(message) : view(message, anyMatType(message.encoding));
}

void requireEncoding(const cv::Mat& pixels, const std::string& encoding)
{
  if (isMessageEncoding(encoding)) return checkPixels(pixels, encoding);
  const int type = anyMatType(encoding);
  if (pixels.empty()) throw std::invalid_argument("the image has no pixels");
  if (pixels.type() != type)
    throw std::invalid_argument(encoding + " image: expected pixels of " + describePixels(type) + ", got " +
                                describePixels(pixels.type()));
}

cv::Mat convertPixels(const sensor_msgs::Image& message, const std::string& encoding,
                      const std::function<cv::Mat(cv::Size)>& make)
{
  const cv::Mat pixels = viewAnyPixels(message);
  if (encoding == message.encoding) return pixels;
  try
  {
    cv::Mat converted;
    const bool common = encoding == "bgr8" || encoding == "rgb8" || encoding == "mono8";
    if (common && isMessageEncoding(message.encoding))
    {
      if (make) converted = make(pixels.size());
      toEncoding(pixels, message.encoding, encoding, converted);
    }
    else
      converted = convertByCvBridge(pixels, message.encoding, encoding);
    return converted;
  }
  catch (const std::exception& e)
  {
    throw std::invalid_argument("cannot be converted to '" + encoding + "': " + printable(e.what(), 300));
  }
}

std::string describeRefusal(const sensor_msgs::Image& message, const std::string& topic, const std::string& reason)
{
  return "refused a frame on " + topic + " (" + printable(message.encoding) + ", " +
         sizeText(message.width, message.height) + "): " + reason;
}

void layOut(cv::Size size, const std::string& encoding, sensor_msgs::Image& message)
{
  message.encoding = encoding;
  message.width = static_cast<std::uint32_t>(size.width);
  message.height = static_cast<std::uint32_t>(size.height);
  message.step = static_cast<std::uint32_t>(size.width * CV_ELEM_SIZE(anyMatType(encoding)));
  message.is_bigendian = isLittleEndianHost() ? 0 : 1;
  message.data.resize(std::size_t{message.step} * message.height);  // which does nothing to shared memory of that size
}

sensor_msgs::ImagePtr ImagePool::take(cv::Size size, const std::string& encoding) const
{
  const std::size_t bytes = std::size_t{CV_ELEM_SIZE(anyMatType(encoding))} * size.width * size.height;
  sensor_msgs::ImagePtr message;
  for (auto topic = topics_.begin(); topic != topics_.end() && !message; ++topic)
    message = (*topic)->make(bytes);
  if (!message) message = take();
  layOut(size, encoding, *message);
  return message;
}

sensor_msgs::ImagePtr ImageMaker::make(const Fill& fill)
{
  cv::Mat pixels = lent_ ? writablePixels(*lent_) : lend();
  const sensor_msgs::ImagePtr guess = std::move(lent_);
  encoding_ = fill(pixels);
  size_ = pixels.size();
  if (guess && pixels.data == guess->data.data())
  {
    guess->encoding = encoding_;
    return guess;
  }
  const sensor_msgs::ImagePtr image = pool_.take(size_, encoding_);
  cv::Mat target = writablePixels(*image);
  pixels.copyTo(target);
  if (image->data.size() > ImagePool::kMaxKept) size_ = {};
  return image;
}

cv::Mat ImageMaker::lend()
{
  lent_ = size_.empty() ? nullptr : pool_.take(size_, encoding_);
  return lent_ ? writablePixels(*lent_) : cv::Mat();
}

cv::Mat writablePixels(sensor_msgs::Image& message)
{
  return {static_cast<int>(message.height), static_cast<int>(message.width), anyMatType(message.encoding),
          message.data.data(), message.step};
}

}  // namespace robot_vision
