#pragma once

#include <opencv2/core.hpp>
#include <opencv2/objdetect.hpp>
#include <vector>

#include "robot_vision/faces/face_detector.hpp"

namespace robot_vision
{

/// Searches faces for eyes.
class EyeSearch
{
public:
  /// Finds no eyes if the parameters name no cascade for them. Throws std::invalid_argument if it cannot be read.
  explicit EyeSearch(const FaceParams& params);

  /// Up to two eyes in a face (px) of a gray image, the left one in the image first.
  std::vector<cv::Rect> find(const cv::Mat& gray, const cv::Rect& face);

private:
  cv::CascadeClassifier cascade_;
};

}  // namespace robot_vision
