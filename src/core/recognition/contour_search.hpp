#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "robot_vision/recognition/recognition_frame.hpp"

namespace robot_vision
{

/// Looks for the contours of an object along lines of a frame.
class ContourSearch
{
public:
  static constexpr int kMaxRadius = 24;  // px

  /// `min_gradient` is that of the frame's gradients from which a pixel can be part of a contour.
  ContourSearch(const RecognitionFrame& frame, double min_gradient) : frame_(frame), min_gradient_(min_gradient) {}

  /// How far (px) the steepest place is from `from` along `normal`, of those up to `radius` px away whose colors change
  /// along it; what is near counts more. Empty if there is none.
  std::optional<double> colorEdge(const cv::Point2d& from, const cv::Vec2f& normal, int radius) const;

  /// How far the place is where a surface at about this depth (m, within `gate`) ends before something farther away.
  std::optional<double> depthEdge(const cv::Point2d& from, const cv::Vec2f& normal, int radius, double depth,
                                  double gate) const;

  /// The depth (m) at a pixel position; NaN where there is none.
  float depthAt(const cv::Point2d& place) const;

private:
  const RecognitionFrame& frame_;
  double min_gradient_;
};

}  // namespace robot_vision
