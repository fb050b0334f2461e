#pragma once

#include <opencv2/core.hpp>
#include <opencv2/objdetect.hpp>
#include <vector>

namespace robot_vision
{

/// Up to two eyes in a face (px) of a gray image, the left one in the image first. None if the cascade is empty.
std::vector<cv::Rect> findEyes(cv::CascadeClassifier& cascade, const cv::Mat& gray, const cv::Rect& face);

}  // namespace robot_vision
