#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <opencv2/core.hpp>

#include "ros/images/message_pool.hpp"

namespace robot_vision
{

/// A pool of organised clouds, see MessagePool.
class CloudPool : public MessagePool<sensor_msgs::PointCloud2>
{
public:
  using MessagePool::take;

  /// Takes a message for a cloud with a point for each pixel of an image of this size: x, y and z, and with `colored`
  /// rgb, each point in 16 bytes. Its header and points are undefined.
  sensor_msgs::PointCloud2Ptr take(const cv::Size& size, bool colored) const;
};

/// The points of such a message, CV_32FC4, to be written.
cv::Mat writablePoints(sensor_msgs::PointCloud2& cloud);

}  // namespace robot_vision
