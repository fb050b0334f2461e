#include <robot_vision/BrightnessConfig.h>

#include <boost/make_shared.hpp>
#include <pluginlib/class_list_macros.hpp>

#include "factories.hpp"
#include "robot_vision/filters/brightness.hpp"
#include "ros/images/filter_nodelet.hpp"

namespace robot_vision
{

/// Publishes `image` with gain, offset and gamma changed on ~processed_image.
using BrightnessNodelet = FilterNodelet<BrightnessConfig, BrightnessParams, Brightness>;

boost::shared_ptr<nodelet::Nodelet> makeBrightness()
{
  return boost::make_shared<BrightnessNodelet>();
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::BrightnessNodelet, nodelet::Nodelet)
