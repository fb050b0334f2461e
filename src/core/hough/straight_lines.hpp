#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/hough/hough.hpp"

namespace robot_vision
{

/// The lines in an image of edges by cv::HoughLines, those with most votes first, each clipped to the image. Throws
/// std::invalid_argument if rho and theta are too fine or too coarse for its size.
std::vector<HoughLine> findStraightLines(const cv::Mat& edges, const HoughParams& params);

/// The segments in an image of edges by cv::HoughLinesP, the longest first. Throws in the same way.
std::vector<HoughLine> findSegments(const cv::Mat& edges, const HoughParams& params);

}  // namespace robot_vision
