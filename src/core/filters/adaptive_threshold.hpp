#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// Equals cv::adaptiveThreshold with ADAPTIVE_THRESH_MEAN_C and 255 for CV_8UC1, to the bit. `out` is reused if it
/// fits, and must not be `gray`.
void adaptiveMeanThreshold(const cv::Mat& gray, int size, double offset, bool inverse, cv::Mat& out);

}  // namespace robot_vision
