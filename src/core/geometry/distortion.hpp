#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// A distorted point on the plane z = 1, and its derivative with respect to the undistorted point.
struct Distorted
{
  cv::Point2d point;
  cv::Matx22d jacobian;
};

/// The lens distortion of a camera, which must be valid.
class Distortion
{
public:
  explicit Distortion(const CameraModel& camera);

  Distorted distort(const cv::Point2d& point) const;

private:
  friend class Undistortion;

  std::array<double, 8> D_ = {};  // zeros where the camera has fewer
  bool equidistant_;
};

/// The inverse of the lens distortion of a camera, which must be valid, on the part of the plane z = 1 that a lens
/// shows: a distortion model may show the same places of the image again for points that are farther from the axis.
class Undistortion
{
public:
  explicit Undistortion(const CameraModel& camera);

  /// The inverse of distort(), exact to the last bits, found from a guess near by. NaN if no point where the distortion
  /// model holds() is distorted to `target`, which happens outside of the image.
  cv::Point2d undistort(const cv::Point2d& target, const cv::Point2d& guess) const;

  /// Whether a lens shows a point: whatever is farther from the axis, up to the point and a little beyond it, is seen
  /// farther out in the image, too, and on the same side.
  bool holds(const cv::Point2d& point) const;

private:
  Distortion lens_;
  double turn_;  // the square of a distance from the axis, of an equidistant lens of an angle, beyond all that it shows
};

}  // namespace robot_vision
