#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <memory>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// A pool of messages of organised clouds, which are used again when nobody in the process holds them any more, so that
/// large clouds cost no page faults. Thread-safe.
class CloudPool
{
public:
  CloudPool();

  /// Takes a message for a cloud with a point for each pixel of an image of this size: x, y and z, and with `colored`
  /// rgb, each point in 16 bytes. Its header and points are undefined.
  sensor_msgs::PointCloud2Ptr take(const cv::Size& size, bool colored) const;

private:
  class Store;
  std::shared_ptr<Store> store_;
};

/// The points of such a message, CV_32FC4, to be written.
cv::Mat writablePoints(sensor_msgs::PointCloud2& cloud);

}  // namespace robot_vision
