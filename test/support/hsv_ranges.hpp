#pragma once

#include <opencv2/core.hpp>
#include <sstream>
#include <string>

#include "robot_vision/color/hsv.hpp"

inline robot_vision::HsvRange hsvRange(const cv::Vec3i& low, const cv::Vec3i& high)
{
  return {low[0], low[1], low[2], high[0], high[1], high[2]};
}

inline std::string text(const robot_vision::HsvRange& r)
{
  const cv::Vec6i limits(r.h_low, r.s_low, r.v_low, r.h_high, r.s_high, r.v_high);
  std::ostringstream stream;
  stream << limits;
  return stream.str();
}
