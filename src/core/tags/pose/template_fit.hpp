#pragma once

#include <array>
#include <optional>
#include <vector>

#include "robot_vision/tags/pose/tag_pose.hpp"
#include "tag_template.hpp"

namespace robot_vision
{

/// The gray level of a pixel and its position (px) without the distortion of the lens.
struct GraySample
{
  cv::Point2d position;
  double gray;
};

/// The fitted corners of a template (px, in TagCorners' order) with their covariance.
struct FittedCorners
{
  std::array<cv::Point2d, 4> corners;
  CornerCovariance covariance;
};

/// Fits a blurred and evenly shaded template to the samples, starting at `corners`, by the method of Levenberg and
/// Marquardt. The result is empty if the template does not look like the samples.
std::optional<FittedCorners> fitTemplate(const TagTemplate& tag_template, const std::vector<GraySample>& samples,
                                         const std::array<cv::Point2d, 4>& corners);

}  // namespace robot_vision
