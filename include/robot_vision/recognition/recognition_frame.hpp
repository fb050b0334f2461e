#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// What a camera without distortion sees at one time: colors, depths or both, prepared for all who refine and verify
/// poses in it.
class RecognitionFrame
{
public:
  /// Throws std::invalid_argument as validate() of the camera does, and if its lens has distortion: images must have
  /// been rectified.
  explicit RecognitionFrame(const CameraModel& camera);

  /// Takes the images of a frame. `bgr` is CV_8UC3 or empty, and is not copied: it must stay as it is as long as the
  /// frame is used. `depth` is of `encoding` (see depth_image.hpp) or empty. Throws std::invalid_argument for images of
  /// another type or size than the camera's, and if both are empty.
  void set(const cv::Mat& bgr, const cv::Mat& depth, const std::string& encoding = "32FC1");

  const CameraModel& camera() const { return camera_; }
  cv::Size size() const { return {camera_.width, camera_.height}; }
  bool hasColors() const { return !bgr_.empty(); }
  bool hasDepth() const { return !depth_.empty(); }

  const cv::Mat& bgr() const { return bgr_; }
  const cv::Mat& depth() const { return depth_; }  // CV_32FC1, m, NaN: none

  /// CV_16SC2: how the color channel that changes most does so along x and y (Sobel's 3x3 kernels). Empty without
  /// colors.
  const cv::Mat& gradients() const { return gradients_; }

private:
  CameraModel camera_;
  cv::Mat bgr_, depth_, metres_, gradients_;
};

}  // namespace robot_vision
