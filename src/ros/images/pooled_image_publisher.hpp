#pragma once

#include <image_transport/image_transport.h>
#include <std_msgs/Header.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>

#include "callback_gate.hpp"
#include "image_message.hpp"

namespace robot_vision
{

/// Publishes images on a topic over all installed image_transports. Thread-safe.
class PooledImagePublisher
{
public:
  /// `topic` is absolute. `on_connection` is called through the queue of `it` when subscribers come or go; `between` is
  /// that of a gate to this queue.
  PooledImagePublisher(const std::string& topic, image_transport::ImageTransport& it,
                       const std::function<void()>& on_connection, CallbackGate::Between between);
  ~PooledImagePublisher() { close(); }
  PooledImagePublisher(const PooledImagePublisher&) = delete;
  PooledImagePublisher& operator=(const PooledImagePublisher&) = delete;

  /// To be called by no callback of `it`.
  void close();
  std::uint32_t subscribers() const;
  const std::shared_ptr<SharedTopic>& sharedTopic() const { return shared_topic_; }

  /// Publishes a copy of the pixels if there are subscribers. The number in the header is replaced by that of the image
  /// on the topic, which roscpp gives only to those of other processes. Throws std::invalid_argument naming what was
  /// expected if the pixels cannot be an image of this encoding (any that cv_bridge knows).
  void publish(const cv::Mat& pixels, const std::string& encoding, const std_msgs::Header& header);

private:
  const CallbackGate::Between between_;
  std::shared_ptr<SharedTopic> shared_topic_;
  mutable std::mutex mutex_;  // guards all below
  image_transport::Publisher publisher_;
  ImagePool pool_;
  std::uint32_t published_ = 0;  // number of images
};

}  // namespace robot_vision
