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

  /// The inverse of distort(), exact to the last bits, found from a guess near by. NaN if no point is distorted to
  /// `target`, which happens outside of the image, where the distortion model does not hold(): there it shows points on
  /// the other side of the axis.
  cv::Point2d undistort(const cv::Point2d& target, const cv::Point2d& guess) const;

  /// Whether what is farther from the axis than a point is seen farther out in the image, too, and on the same side.
  static bool holds(const Distorted& seen, const cv::Point2d& point);

private:
  std::array<double, 8> D_ = {};  // zeros where the camera has fewer
  bool equidistant_;
};

}  // namespace robot_vision
