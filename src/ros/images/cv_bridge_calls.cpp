#include "cv_bridge_calls.hpp"

#include "robot_vision/common/on_demand.hpp"

namespace robot_vision
{

int typeByCvBridge(const std::string& encoding)
{
  static auto* const type = onDemand<decltype(robot_vision_cv_type)>("conversions", "robot_vision_cv_type");
  return type(encoding);
}

cv::Mat convertByCvBridge(const cv::Mat& image, const std::string& from, const std::string& to)
{
  static auto* const convert = onDemand<decltype(robot_vision_convert)>("conversions", "robot_vision_convert");
  cv::Mat converted;
  convert(image, from, to, converted);
  return converted;
}

}  // namespace robot_vision
