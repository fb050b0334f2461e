#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

constexpr int kFractionBits = 4;  // of the positions and lengths that OpenCV draws at

inline int fixedPoint(double pixels)
{
  return cvRound(pixels * (1 << kFractionBits));
}

inline cv::Point fixedPoint(const cv::Point2d& point)
{
  return {fixedPoint(point.x), fixedPoint(point.y)};
}

}  // namespace robot_vision
