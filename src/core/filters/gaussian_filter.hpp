#pragma once

#include <opencv2/core.hpp>

#include "core/image/gaussian_filter_rows.hpp"

namespace robot_vision
{

/// Equals cv::GaussianBlur with its default border, the image by itself, for 1 to 4 channels, to the bit. Bytes are
/// summed by kernels, by as many threads as cv::setNumThreads() allows; images of another depth are OpenCV's.
class GaussianFilter
{
public:
  /// `size` is the side of the window (px, odd, 1 to 255), 0 for the one that OpenCV derives from `sigma`. `sigma` is
  /// in px, 0 for the one that OpenCV derives from the size; only one of the two may be 0.
  GaussianFilter(int size, double sigma);

  /// `out` is reused if it fits, and must not be `image`.
  void apply(const cv::Mat& image, cv::Mat& out) const;

private:
  int size_;
  double sigma_;
  GaussWeights weights_;
  bool exact_;  // whether kernels with these weights do what OpenCV does
};

}  // namespace robot_vision
