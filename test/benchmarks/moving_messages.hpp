#pragma once

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <string>
#include <vector>

#include "measure.hpp"

namespace bench
{

/// The pixels of a message, shared with it.
inline cv::Mat view(const sensor_msgs::Image& message, int type)
{
  return {static_cast<int>(message.height), static_cast<int>(message.width), type,
          const_cast<std::uint8_t*>(message.data.data()), message.step};
}

/// A photograph that moves, or a box that moves before it, as messages.
inline std::vector<sensor_msgs::ImagePtr> movingMessages(const std::string& path, cv::Size size, bool still)
{
  std_msgs::Header header;
  header.frame_id = "camera";
  const std::vector<cv::Mat> moving = movingImage(path, size);
  std::vector<sensor_msgs::ImagePtr> messages;
  for (const cv::Mat& image : still ? withBoxes(moving, {{0.25, 1.0 / 3.0}}) : moving)
    messages.push_back(cv_bridge::CvImage(header, sensor_msgs::image_encodings::BGR8, image).toImageMsg());
  return messages;
}

}  // namespace bench
