#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace robot_vision
{

/// cv_bridge::getCvType and cvtColor, whose library is loaded by the first call, see on_demand.hpp: it brings that of
/// OpenCV along which reads files. They throw std::exception as cv_bridge does.
int typeByCvBridge(const std::string& encoding);
cv::Mat convertByCvBridge(const cv::Mat& image, const std::string& from, const std::string& to);

}  // namespace robot_vision

extern "C"
{
  // Those of the library "conversions".
  int robot_vision_cv_type(const std::string& encoding);
  void robot_vision_convert(const cv::Mat& image, const std::string& from, const std::string& to, cv::Mat& converted);
}
