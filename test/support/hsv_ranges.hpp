#pragma once

#include <opencv2/core.hpp>
#include <sstream>
#include <string>

#include "robot_vision/color/hsv.hpp"

inline robot_vision::HsvRange hsvRange(const cv::Vec3i& low, const cv::Vec3i& high)
{
  robot_vision::HsvRange range;
  range.h_low = low[0];
  range.s_low = low[1];
  range.v_low = low[2];
  range.h_high = high[0];
  range.s_high = high[1];
  range.v_high = high[2];
  return range;
}

inline std::string text(const robot_vision::HsvRange& r)
{
  const cv::Vec6i limits(r.h_low, r.s_low, r.v_low, r.h_high, r.s_high, r.v_high);
  std::ostringstream stream;
  stream << limits;
  return stream.str();
}
