#include <robot_vision/EdgeDetectorConfig.h>

#include <boost/make_shared.hpp>
#include <pluginlib/class_list_macros.hpp>

#include "factories.hpp"
#include "robot_vision/edges/edges.hpp"
#include "ros/images/filter_nodelet.hpp"

namespace robot_vision
{
namespace
{

EdgeDetector makeFilter(const EdgeDetectorConfig& config)
{
  EdgeParams params;
  params.blur_size = config.blur_size;
  params.low_threshold = config.low_threshold;
  params.high_threshold = config.high_threshold;
  params.aperture = config.aperture;
  params.l2_gradient = config.l2_gradient;
  params.threads = config.threads;
  return EdgeDetector(params);
}

}  // namespace

/// Publishes the Canny edges of `image` on ~processed_image.
class EdgeDetectorNodelet : public FilterNodelet<EdgeDetectorConfig, EdgeDetector>
{
public:
  EdgeDetectorNodelet() : FilterNodelet(makeFilter) {}
};

boost::shared_ptr<nodelet::Nodelet> makeEdgeDetector()
{
  return boost::make_shared<EdgeDetectorNodelet>();
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::EdgeDetectorNodelet, nodelet::Nodelet)
