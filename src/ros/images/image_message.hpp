#pragma once

#include <sensor_msgs/Image.h>

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "message_pool.hpp"
#include "shared_topic.hpp"

namespace robot_vision
{

/// The message's pixels as a cv::Mat on the same memory; only 16-bit pixels of the other byte order are copied. The
/// memory is shared with all other subscribers in the process, so it must not be written to.
/// Throws std::invalid_argument naming encoding, size and the mismatch unless encoding, width, height, step, data and
/// is_bigendian agree with each other.
cv::Mat viewPixels(const sensor_msgs::Image& message);

/// The cv::Mat type of an encoding, for all encodings that cv_bridge knows (8UC1, 16-bit colour, 32FC1, ...), not only
/// the core's. Throws std::invalid_argument naming the encoding if it is unknown.
int anyMatType(const std::string& encoding);

/// Like viewPixels(), for all these encodings.
cv::Mat viewAnyPixels(const sensor_msgs::Image& message);

/// The image in `encoding`: a view if the message has this encoding, otherwise converted as cv_bridge does, to memory
/// of its own, or that of `make(size)` if the conversion can write there. Throws std::invalid_argument as viewPixels()
/// does, and if there is no such conversion.
cv::Mat convertPixels(const sensor_msgs::Image& message, const std::string& encoding,
                      const std::function<cv::Mat(cv::Size)>& make = nullptr);

/// Throws std::invalid_argument naming the expected type and size unless `pixels` can be an image of `encoding` (any
/// that cv_bridge knows).
void requireEncoding(const cv::Mat& pixels, const std::string& encoding);

/// The log line for an image that is refused: topic, encoding, size and reason.
std::string describeRefusal(const sensor_msgs::Image& message, const std::string& topic, const std::string& reason);

/// Gives a message the layout of an image of this size and encoding (any that cv_bridge knows), without padding. Its
/// header and pixels are undefined.
void layOut(cv::Size size, const std::string& encoding, sensor_msgs::Image& message);

/// A pool of images, see MessagePool. Those that are made for certain topics stand in shared memory while somebody
/// reads such a topic over shm, so that they are not copied when they are published.
class ImagePool : public MessagePool<sensor_msgs::Image>
{
public:
  using MessagePool::take;

  /// Adds a topic on which the images are going to be published.
  void addTopic(std::shared_ptr<SharedTopic> topic) { topics_.push_back(std::move(topic)); }

  /// Takes a message for an image of this size and encoding; its header and pixels are undefined.
  sensor_msgs::ImagePtr take(cv::Size size, const std::string& encoding) const;

private:
  std::vector<std::shared_ptr<SharedTopic>> topics_;
};

/// Makes messages for a stream of images whose size is known only when they are there. Not thread-safe.
class ImageMaker
{
public:
  /// Writes an image into the cv::Mat, which has the memory of a message with the size of the last one, or replaces the
  /// cv::Mat. Returns the image's encoding.
  using Fill = std::function<std::string(cv::Mat&)>;

  /// A message with the image; its header is undefined.
  sensor_msgs::ImagePtr make(const Fill& fill);

  /// The memory that the next call of make() starts from, to be written before that; empty if no size is known yet.
  cv::Mat lend();

  /// See ImagePool.
  void addTopic(const std::shared_ptr<SharedTopic>& topic) { pool_.addTopic(topic); }
  std::size_t kept() const { return pool_.kept(); }

private:
  ImagePool pool_;
  cv::Size size_;  // of the last image; empty if it was too large to be kept
  std::string encoding_;
  sensor_msgs::ImagePtr lent_;
};

/// The pixels of a message from the pool, which may be written.
cv::Mat writablePixels(sensor_msgs::Image& message);

}  // namespace robot_vision
