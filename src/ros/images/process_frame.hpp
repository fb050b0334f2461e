#pragma once

#include <sensor_msgs/Image.h>

#include <map>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "image_message.hpp"

namespace robot_vision
{

/// An image that was received, for all nodes of the process that take it. Thread-safe.
class ProcessFrame
{
public:
  /// Memory for what is converted is taken from the pool, whatever thread converts: memory that is freed by malloc()
  /// stays with the thread that has asked for it.
  ProcessFrame(sensor_msgs::ImageConstPtr message, ImagePool pool)
    : message_(std::move(message)), pool_(std::move(pool))
  {
  }

  const sensor_msgs::ImageConstPtr& message() const { return message_; }

  /// An image, and what holds its memory; null if the image itself does.
  struct Pixels
  {
    cv::Mat image;
    sensor_msgs::ImageConstPtr owner;
  };

  /// The image in an encoding, or as it is for "". Those who ask for the same get the same memory, which nobody may
  /// write to: the first one converts, the others wait for that. Throws as convertPixels() does.
  Pixels pixels(const std::string& encoding);

private:
  struct Conversion
  {
    std::mutex mutex;  // guards all below; held while the pixels are converted
    bool done = false;
    Pixels pixels;
    std::string refusal;
  };

  Pixels convert(const std::string& encoding) const;

  sensor_msgs::ImageConstPtr message_;
  ImagePool pool_;
  std::mutex mutex_;                               // guards the map, whose members stay where they are
  std::map<std::string, Conversion> conversions_;  // by encoding
};

}  // namespace robot_vision
