#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// cv::inRange of pixels (CV_8UC3), limits included, into `mask` (CV_8UC1). With `through_red` the range of the first
/// channel is from its low limit to 255 and from 0 to its high one; `rest` is memory for that.
void findInRange(const cv::Mat& pixels, const cv::Vec3i& low, const cv::Vec3i& high, bool through_red, cv::Mat& mask,
                 cv::Mat& rest);

}  // namespace robot_vision
