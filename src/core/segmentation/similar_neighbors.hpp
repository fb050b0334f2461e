#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// Numbers (CV_32SC1, from 1) the regions of an image (CV_8UC3) in which a path leads from each pixel to each other,
/// up, down, left and right, along which neighbours differ by at most `tolerance` gray levels in each channel: what
/// cv::floodFill fills with this difference up and down. The region of the first pixel comes first.
cv::Mat similarNeighbors(const cv::Mat& bgr, double tolerance);

}  // namespace robot_vision
