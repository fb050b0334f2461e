#include <robot_vision/EdgeDetectorConfig.h>

#include <boost/make_shared.hpp>
#include <pluginlib/class_list_macros.hpp>

#include "factories.hpp"
#include "robot_vision/edges/edges.hpp"
#include "ros/images/filter_nodelet.hpp"

namespace robot_vision
{

/// Publishes the Canny edges of `image` on ~processed_image.
using EdgeDetectorNodelet = FilterNodelet<EdgeDetectorConfig, EdgeParams, EdgeDetector>;

boost::shared_ptr<nodelet::Nodelet> makeEdgeDetector()
{
  return boost::make_shared<EdgeDetectorNodelet>();
}

}  // namespace robot_vision

PLUGINLIB_EXPORT_CLASS(robot_vision::EdgeDetectorNodelet, nodelet::Nodelet)
