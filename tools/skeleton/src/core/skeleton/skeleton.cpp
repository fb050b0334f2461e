#include "robot_vision/skeleton/skeleton.hpp"

#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{

double measureSkeleton(const cv::Mat& image, const std::string& encoding, const SkeletonParams& params)
{
  validate(params);
  cv::Mat gray;
  toGray(image, encoding, gray);
  if (gray.empty()) return 0.0;
  return static_cast<double>(cv::countNonZero(gray > params.threshold)) / static_cast<double>(gray.total());
}

}  // namespace robot_vision
