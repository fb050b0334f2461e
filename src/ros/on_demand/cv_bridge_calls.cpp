#include "ros/images/cv_bridge_calls.hpp"

#include <cv_bridge/cv_bridge.h>

#include <boost/make_shared.hpp>

int robot_vision_cv_type(const std::string& encoding)
{
  return cv_bridge::getCvType(encoding);
}

void robot_vision_convert(const cv::Mat& image, const std::string& from, const std::string& to, cv::Mat& converted)
{
  const auto source = boost::make_shared<const cv_bridge::CvImage>(std_msgs::Header(), from, image);
  converted = cv_bridge::cvtColor(source, to)->image;
}
