#pragma once

#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>

#include <opencv2/core.hpp>
#include <optional>

#include "robot_vision/depth/depth_points.hpp"
#include "robot_vision/stereo/stereo_camera.hpp"
#include "ros/depth/cloud_pool.hpp"

namespace robot_vision
{

/// Makes clouds of the depths of a pair's rectified left camera, with the colors of its rectified images. The rays of
/// the camera are computed anew only when it is another one.
class StereoPoints
{
public:
  /// An organised cloud of x, y, z and rgb in the rectified left optical frame. `depth` is CV_32FC1, m, NaN where there
  /// is none, and `bgr` CV_8UC3, both of the camera's size.
  sensor_msgs::PointCloud2Ptr cloud(const std_msgs::Header& header, const RectifiedCamera& left, const cv::Mat& depth,
                                    const cv::Mat& bgr);

private:
  CloudPool pool_;
  std::optional<DepthPoints> maker_;
};

}  // namespace robot_vision
