#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// The depth (m) of a pixel of a depth image (CV_16UC1 in mm or CV_32FC1 in m), NaN where there is none.
inline double depthAt(const cv::Mat& depth, int x, int y)
{
  const double z =
      depth.type() == CV_16UC1 ? depth.at<std::uint16_t>(y, x) / 1000.0 : static_cast<double>(depth.at<float>(y, x));
  return std::isfinite(z) && z > 0.0 ? z : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace robot_vision
