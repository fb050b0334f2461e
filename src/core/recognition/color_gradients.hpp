#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// Writes how the channel of a CV_8UC3 image that changes most at a pixel does so along x and y, by Sobel's kernels of
/// 3x3, into `gradients` (CV_16SC2), which is reused if it fits. At the border of the image they are 0.
void colorGradients(const cv::Mat& bgr, cv::Mat& gradients);

}  // namespace robot_vision
