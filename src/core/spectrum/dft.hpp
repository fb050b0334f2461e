#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// The gray image (CV_8UC1) less `black` as CV_32FC1, times a Hann window if `is_faded`: the product of one in each
/// direction, of which one below 3 px, where it would be 0 everywhere, is left out.
cv::Mat toFloat(const cv::Mat& gray, bool is_faded, double black = 0.0);

/// The size itself, or if `is_optimal` the next one that cv::dft is fast with.
cv::Size dftSize(const cv::Size& size, bool is_optimal);

/// The image moved cyclically by half its size, rounded down: (0, 0) comes to the middle (cols / 2, rows / 2).
cv::Mat centered(const cv::Mat& image);

/// The reverse of centered(), which is another thing for odd sizes.
cv::Mat uncentered(const cv::Mat& image);

}  // namespace robot_vision
