#include <robot_vision/BrightnessConfig.h>

#include <boost/make_shared.hpp>
#include <pluginlib/class_list_macros.hpp>

#include "factories.hpp"
#include "robot_vision/filters/brightness.hpp"
#include "ros/images/filter_nodelet.hpp"

namespace robot_vision
{
namespace
{

Brightness makeFilter(const BrightnessConfig& config)
{
  BrightnessParams params;
  params.gain = config.gain;
  params.offset = config.offset;
  params.gamma = config.gamma;
  params.threads = config.threads;
  return Brightness(params);
}

}  // namespace

/// Publishes `image` with gain, offset and gamma changed on ~processed_image.
class BrightnessNodelet : public FilterNodelet<BrightnessConfig, Brightness>
{
public:
  BrightnessNodelet() : FilterNodelet(makeFilter) {}
};

boost::shared_ptr<nodelet::Nodelet> makeBrightness()
{
  return boost::make_shared<BrightnessNodelet>();
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::BrightnessNodelet, nodelet::Nodelet)
