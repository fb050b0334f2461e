#pragma once

#include <sensor_msgs/Image.h>

#include <boost/make_shared.hpp>
#include <string>
#include <vector>

#include "measure.hpp"

namespace bench
{

inline sensor_msgs::ImagePtr toMessage(const cv::Mat& bgr)
{
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->header.frame_id = "camera";
  message->encoding = "bgr8";
  message->width = static_cast<std::uint32_t>(bgr.cols);
  message->height = static_cast<std::uint32_t>(bgr.rows);
  message->step = static_cast<std::uint32_t>(bgr.step);
  message->data.assign(bgr.datastart, bgr.dataend);
  return message;
}

/// The pixels of a message, shared with it.
inline cv::Mat view(const sensor_msgs::Image& message, int type)
{
  return {static_cast<int>(message.height), static_cast<int>(message.width), type,
          const_cast<std::uint8_t*>(message.data.data()), message.step};
}

/// stillPicture() or movingPicture() as messages.
inline std::vector<sensor_msgs::ImagePtr> pictureMessages(const std::string& path, cv::Size size, bool still)
{
  std::vector<sensor_msgs::ImagePtr> messages;
  for (const cv::Mat& picture : still ? stillPicture(path, size) : movingPicture(path, size))
    messages.push_back(toMessage(picture));
  return messages;
}

}  // namespace bench
