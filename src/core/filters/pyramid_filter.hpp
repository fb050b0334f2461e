#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// Equals cv::pyrDown to half the size, rounded up, for 1 to 4 channels, to the bit. Bytes are summed by kernels, by as
/// many threads as cv::setNumThreads() allows; images of another depth are OpenCV's. `out` is reused if it fits, and
/// must not be `image`.
void pyramidDown(const cv::Mat& image, cv::Mat& out);

}  // namespace robot_vision
