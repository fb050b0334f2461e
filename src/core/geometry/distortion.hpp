#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// A point of the plane one metre ahead as the lens moves it, and the derivative.
struct Distorted
{
  cv::Point2d point;
  cv::Matx22d jacobian;
};

/// The distortion of a valid camera.
class Distortion
{
public:
  explicit Distortion(const CameraModel& camera);

  Distorted distort(const cv::Point2d& point) const;

  /// The inverse, to the last bits, from a guess near by; NaN where the distortion, which is a model within the picture
  /// at best, has no such point.
  cv::Point2d undistort(const cv::Point2d& target, const cv::Point2d& guess) const;

private:
  std::array<double, 8> D_ = {};  // zeros where the camera has fewer
  bool equidistant_;
};

/// Whether this is a distortion_model that is known: of a lens that is described by angles, or by a polynomial.
bool isEquidistant(const std::string& distortion_model);
bool isPolynomial(const std::string& distortion_model);

}  // namespace robot_vision
