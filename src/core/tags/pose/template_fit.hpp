#pragma once

#include <array>
#include <optional>
#include <vector>

#include "robot_vision/tags/pose/tag_pose.hpp"
#include "tag_template.hpp"

namespace robot_vision
{

/// The gray level of a pixel, at a place where straight lines are straight (px).
struct GreySample
{
  cv::Point2d place;
  double level;
};

/// The corners of a pattern (px, TagCorners' order).
struct FittedPattern
{
  std::array<cv::Point2d, 4> corners;
  CornerCovariance covariance;
};

/// Where a blurred and evenly shaded pattern is most like the samples (Levenberg, Marquardt), near `corners`; nothing
/// if it is not like them.
std::optional<FittedPattern> fitPattern(const Pattern& pattern, const std::vector<GreySample>& samples,
                                        const std::array<cv::Point2d, 4>& corners);

}  // namespace robot_vision
