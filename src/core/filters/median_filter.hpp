#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// Equals cv::medianBlur for 8 bits and 1 to 4 channels, to the bit. Windows of 7, 9 and 11 px are sorted by networks,
/// by as many threads as cv::setNumThreads() allows; others are OpenCV's. `out` is reused if it fits, and must not be
/// `image`.
void medianFilter(const cv::Mat& image, int size, cv::Mat& out);

}  // namespace robot_vision
