#pragma once

#include <opencv2/imgproc.hpp>

#include "robot_vision/geometry/camera_model.hpp"
#include "support/depth_world.hpp"

/// Depth images of the size that is measured, as the contests that are about such images see them.
namespace bench
{

const cv::Size kDepthSize(640, 480);    // of a Kinect
constexpr double kFocalLength = 525.0;  // px, for 640 columns

/// A camera with the field of view of a Kinect, without distortion.
inline robot_vision::CameraModel depthCamera(const cv::Size& size)
{
  const double across = static_cast<double>(size.width) / kDepthSize.width;
  const double along = static_cast<double>(size.height) / kDepthSize.height;
  const cv::Matx33d K(across * kFocalLength, 0, 0.5 * (size.width - 1), 0, along * kFocalLength,
                      0.5 * (size.height - 1), 0, 0, 1);
  return {size.width, size.height, K, {}, "plumb_bob"};
}

/// What such a camera with fewer pixels sees, with pixels doubled and so on.
inline cv::Mat enlarged(const cv::Mat& depth, const cv::Size& size)
{
  cv::Mat large;
  cv::resize(depth, large, size, 0, 0, cv::INTER_NEAREST);
  return large;
}

}  // namespace bench
