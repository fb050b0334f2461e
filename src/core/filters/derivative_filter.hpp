#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace robot_vision
{

/// A first or second derivative. `size` is the side of the kernel, or cv::FILTER_SCHARR.
struct Derivative
{
  int dx = 1;
  int dy = 0;
  int size = 3;
  double scale = 1.0;
};

/// Equals cv::Sobel (or cv::Scharr) to CV_16S and cv::convertScaleAbs for 8 bits and 1 to 4 channels, to the bit.
/// Kernels of 3 and 5 px with scale 1 take one pass, by as many threads as cv::setNumThreads() allows; others are
/// OpenCV's. `out` is reused if it fits, and must not be `image`.
void derivativeMagnitude(const cv::Mat& image, const Derivative& derivative, cv::Mat& out);

}  // namespace robot_vision
