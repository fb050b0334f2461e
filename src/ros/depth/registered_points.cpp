#include "registered_points.hpp"

#include <utility>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "ros/images/image_message.hpp"
#include "ros/images/stamps.hpp"

namespace robot_vision
{
namespace
{

constexpr double kSlop = 0.02;  // s, unless ~slop is set

}  // namespace

RegisteredPoints::RegisteredPoints(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, RegistrationTopics topics)
  : nh_(nh),
    pnh_(pnh),
    it_(nh),
    hints_(readTransport(it_, pnh)),
    topics_(std::move(topics)),
    pairs_(readSlop(pnh, kSlop))
{
}

void RegisteredPoints::listen(bool listens)
{
  if (listens == this->listens()) return;
  subscription_.shutdown();
  pairs_.clear();
  if (!listens) return;
  subscription_ = ImageSubscription(nh_, it_, "rgb/image_raw", hints_,
                                    [this](const sensor_msgs::ImageConstPtr& message) { onColor(message); });
}

bool RegisteredPoints::add(const sensor_msgs::ImageConstPtr& depth, const std::shared_ptr<const DepthPoints>& maker,
                           FrameStatistics& statistics, bool counts)
{
  maker_ = maker;
  statistics_ = &statistics;
  counts_ = counts;
  if (listens())
  {
    const std::optional<ColoredDepth> pair = pairs_.addDepth(depth);
    const std::string problem = pairs_.problem(topics_.depth_image, topics_.color_image);
    if (!problem.empty()) tell(problem);
    return publish(pair);
  }
  const cv::Mat pixels = viewAnyPixels(*depth);
  const auto cloud = pool_.take(pixels.size(), /*colored=*/false);
  cloud->header = depth->header;
  cv::Mat points = writablePoints(*cloud);
  maker->cloud(pixels, depth->encoding, points);
  publish_(cloud);
  return true;
}

void RegisteredPoints::onColor(const sensor_msgs::ImageConstPtr& message)
{
  const auto begin = FrameStatistics::Clock::now();
  const std::optional<ColoredDepth> pair = pairs_.addColor(message);
  if (publish(pair) && counts_) statistics_->published(begin, pair->depth->header.stamp);
}

/// Returns whether it has.
bool RegisteredPoints::publish(const std::optional<ColoredDepth>& pair)
{
  if (!pair) return false;
  try
  {
    publishColored(*pair);
    return true;
  }
  catch (const std::exception& e)
  {
    tell(describeRefusal(*pair->color, topics_.color_image, e.what()));
    return false;
  }
}

void RegisteredPoints::publishColored(const ColoredDepth& pair)
{
  const cv::Mat image = viewPixels(*pair.color), depth = viewAnyPixels(*pair.depth);
  require(image.size() == depth.size(), "its size", toText(image.size()),
          toText(depth.size()) + " as on " + topics_.color_info);
  cv::Mat bgr = std::exchange(converted_, cv::Mat());
  toBgr(image, pair.color->encoding, bgr);
  const auto cloud = pool_.take(image.size(), /*colored=*/true);
  cloud->header = pair.depth->header;
  cv::Mat points = writablePoints(*cloud);
  maker_->cloud(depth, pair.depth->encoding, bgr, points);
  if (bgr.data != image.data) converted_ = bgr;  // not those of the message, which others have
  publish_(cloud);
}

void RegisteredPoints::tell(const std::string& what)
{
  statistics_->refused(what);
  if (throttle_.due()) ROS_ERROR("%s: %s", pnh_.getNamespace().c_str(), what.c_str());
}

}  // namespace robot_vision
