#pragma once

#include <sensor_msgs/Image.h>

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

namespace robot_vision
{

/// The message's pixels as a cv::Mat on the same memory (a copy only for 16-bit pixels of the other byte order). The
/// memory is shared with every other subscriber of the process: read it, never write to it.
/// Throws std::invalid_argument naming encoding, size and the mismatch unless encoding, width, height, step, data and
/// is_bigendian agree with each other.
cv::Mat viewPixels(const sensor_msgs::Image& message);

/// The cv::Mat type of every encoding that cv_bridge knows (8UC1, 16-bit colour, 32FC1, ...), not only of the core's.
/// Throws std::invalid_argument naming the encoding if it is unknown.
int anyMatType(const std::string& encoding);

/// viewPixels() for all of these encodings.
cv::Mat viewAnyPixels(const sensor_msgs::Image& message);

/// The picture in `encoding`: a view where it is in it already, otherwise converted as cv_bridge converts.
/// Throws std::invalid_argument as viewPixels does, and if there is no such conversion.
cv::Mat convertPixels(const sensor_msgs::Image& message, const std::string& encoding);

/// Throws std::invalid_argument naming type and size expected unless `pixels` can be a picture of `encoding` (any that
/// cv_bridge knows).
void requireEncoding(const cv::Mat& pixels, const std::string& encoding);

/// What to log of a picture that is refused: topic, encoding, size and why.
std::string describeRefusal(const sensor_msgs::Image& message, const std::string& topic, const std::string& why);

/// Messages that are reused when nobody in the process holds them any more: large images then cost no page faults.
/// What is kept is bounded, and so that one huge image is not paid for ever, what is far larger than the image that
/// comes back last is let go. Thread-safe; copies share their messages.
class ImagePool
{
public:
  static constexpr std::size_t kMaxKept = std::size_t{1} << 27;  // bytes, of all messages that nobody holds

  ImagePool();

  /// A message; its header, layout and pixels are whatever they were.
  sensor_msgs::ImagePtr take() const;

  /// A message with room for a picture of this size and encoding; its header and pixels are whatever they were.
  sensor_msgs::ImagePtr take(cv::Size size, const std::string& encoding) const;

  /// Bytes of all messages that nobody holds.
  std::size_t kept() const;

private:
  class Store;
  std::shared_ptr<Store> store_;
};

/// Makes messages of a stream of pictures whose size is known only when they are there. Not thread-safe.
class ImageMaker
{
public:
  /// Puts a picture into the cv::Mat, which has the memory of a message as large as the last one, or replaces it, and
  /// returns its encoding.
  using Fill = std::function<std::string(cv::Mat&)>;

  /// A message with the picture; its header is whatever it was.
  sensor_msgs::ImagePtr make(const Fill& fill);

  /// See ImagePool.
  std::size_t kept() const { return pool_.kept(); }

private:
  ImagePool pool_;
  cv::Size size_;  // of the last picture; empty if it was too large to be kept
  std::string encoding_;
};

/// The pixels of a message taken from the pool, to be written.
cv::Mat writablePixels(sensor_msgs::Image& message);

}  // namespace robot_vision
