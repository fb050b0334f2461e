#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace robot_vision
{

/// A similarity transform of the plane, which scales, rotates and shifts a point.
struct Similarity
{
  double a = 1.0, b = 0.0;  // scale times cosine and sine of the angle
  cv::Point2d shift;

  double scale() const { return std::hypot(a, b); }
  double angle() const { return std::atan2(b, a); }  // rad, -pi to pi
  cv::Point2d operator()(const cv::Point2d& p) const;
  std::vector<cv::Point2f> operator()(const std::vector<cv::Point2f>& points) const;
  /// The transform that applies first `inner`, then this.
  Similarity operator*(const Similarity& inner) const;
  cv::Matx23d matrix() const { return {a, -b, shift.x, b, a, shift.y}; }
};

/// Fits the similarity that maps points `from` to points `to`: RANSAC with inliers within `tolerance` px, then least
/// squares over the inliers. None if there are fewer than `min_inliers`. The same points always give the same result.
std::optional<Similarity> fitSimilarity(const std::vector<cv::Point2f>& from, const std::vector<cv::Point2f>& to,
                                        double tolerance, int min_inliers);

}  // namespace robot_vision
