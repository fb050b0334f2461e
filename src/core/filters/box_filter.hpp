#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// Equals cv::blur with this border, the image by itself, for 1 to 4 channels, to the bit. Boxes of 3 to 31 px of bytes
/// are summed by kernels, by as many threads as cv::setNumThreads() allows; others are OpenCV's. `out` is reused if it
/// fits, and must not be `image`.
void boxFilter(const cv::Mat& image, int size, int border, cv::Mat& out);

}  // namespace robot_vision
