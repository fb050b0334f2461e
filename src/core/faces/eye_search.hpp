#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "cascade.hpp"

namespace robot_vision
{

/// Up to two eyes in a face (px) of a gray image, the left one in the image first. None if the cascade is empty.
std::vector<cv::Rect> findEyes(Cascade& cascade, const cv::Mat& gray, const cv::Rect& face);

}  // namespace robot_vision
