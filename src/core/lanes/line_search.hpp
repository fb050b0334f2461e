#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/lanes/lane_detector.hpp"

namespace robot_vision::lanes
{

/// The middles of the lines in each row of a mask of the view from above: their columns, px.
using Middles = std::vector<std::vector<double>>;
Middles middlesOf(const cv::Mat& mask);

/// Middles that may belong to one line, px of the view.
using Places = std::vector<cv::Point2d>;

/// What may be lines: begun at the peaks of histograms and followed upwards by windows of `half_width` px to both
/// sides, in a view of so many columns. There are at most kMaxLines.
std::vector<Places> followLines(const Middles& middles, int columns, double half_width, const LaneParams& params);

/// The middles within `half_width` px of one column for each row.
Places middlesAround(const Middles& middles, const std::vector<double>& columns, double half_width);

constexpr std::size_t kMaxLines = 8;

}  // namespace robot_vision::lanes
