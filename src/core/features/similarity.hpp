#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace robot_vision
{

/// A similarity of the plane: a point is scaled, turned and shifted.
struct Similarity
{
  double a = 1.0, b = 0.0;  // scale times cosine and sine of the angle
  cv::Point2d shift;

  double scale() const;
  double angle() const;  // rad, -pi to pi
  cv::Point2d operator()(const cv::Point2d& p) const;
  std::vector<cv::Point2f> operator()(const std::vector<cv::Point2f>& points) const;
  /// First `inner`, then this.
  Similarity operator*(const Similarity& inner) const;
  cv::Matx23d matrix() const;
};

/// The similarity from one set of points to the other that most pairs agree with, to `tolerance` px: least squares over
/// those pairs. None if there are fewer than `least`. The same for the same points.
std::optional<Similarity> fitSimilarity(const std::vector<cv::Point2f>& from, const std::vector<cv::Point2f>& to,
                                        double tolerance, int least);

}  // namespace robot_vision
