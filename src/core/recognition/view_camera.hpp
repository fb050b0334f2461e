#pragma once

#include <opencv2/core.hpp>

#include "padded_image.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// The camera without distortion whose small images objects are looked for in: of the resolution of a VGA depth camera
/// with half as many pixels, or of what the real one has if that is less.
class ViewCamera
{
public:
  ViewCamera() = default;

  /// Throws std::invalid_argument as validate() does, and for a camera that is not calibrated.
  explicit ViewCamera(const CameraModel& camera);

  const CameraModel& camera() const { return camera_; }  // the real one
  const cv::Size& size() const { return size_; }
  int block() const { return block_; }  // px of the real camera, of a row that become one pixel
  double fx() const { return fx_; }     // px
  double fy() const { return fy_; }
  double cx() const { return cx_; }
  double cy() const { return cy_; }
  double focalLength() const { return 0.5 * (fx_ + fy_); }
  cv::Matx33d K() const { return {fx_, 0, cx_, 0, fy_, cy_, 0, 0, 1}; }

  /// x of the rays (x, y, 1) of a row, and 1 / their lengths.
  const float* rayX() const { return ray_x_.data(); }
  const float* inverseLengths(int y) const { return inverse_lengths_[y]; }
  float rayY(int y) const { return static_cast<float>((y - cy_) / fy_); }

  /// Where its pixels are in images of the real camera after their reduction, as cv::remap takes it (CV_32FC2); empty:
  /// in the same place.
  const cv::Mat& places() const { return places_; }

private:
  void findPlaces();

  CameraModel camera_;
  cv::Size size_;
  int block_ = 1;
  double fx_ = 0.0, fy_ = 0.0, cx_ = 0.0, cy_ = 0.0;
  std::vector<float> ray_x_;
  PaddedImage<float> inverse_lengths_;
  cv::Mat places_;
};

}  // namespace robot_vision
