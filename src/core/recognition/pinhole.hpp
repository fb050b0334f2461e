#pragma once

#include <cmath>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// A camera without distortion, in few operations a point.
struct Pinhole
{
  explicit Pinhole(const cv::Matx33d& K) : fx(K(0, 0)), fy(K(1, 1)), skew(K(0, 1)), cx(K(0, 2)), cy(K(1, 2)) {}

  /// The pixel position of a point (m), whose z is above 0.
  cv::Point2d project(const cv::Vec3d& point) const
  {
    const double inverse = 1.0 / point[2], y = point[1] * inverse;
    return {fx * point[0] * inverse + skew * y + cx, fy * y + cy};
  }

  /// The ray (x, y, 1) of a pixel position.
  cv::Vec3d ray(double u, double v) const
  {
    const double y = (v - cy) / fy;
    return {(u - cx - skew * y) / fx, y, 1.0};
  }

  /// The way (m) that a pixel is wide at a depth of 1 m.
  double pixelWidth() const { return 1.0 / std::sqrt(fx * fy); }

  double fx, fy, skew, cx, cy;
};

}  // namespace robot_vision
