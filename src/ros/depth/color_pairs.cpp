#include "color_pairs.hpp"

#include <utility>

#include "robot_vision/common/range.hpp"
#include "ros/images/stamps.hpp"
#include "ros/images/waiting_images.hpp"

namespace robot_vision
{
std::optional<ColoredDepth> ColorPairs::addDepth(const sensor_msgs::ImageConstPtr& depth)
{
  std::optional<ColoredDepth> before = pair(false);
  ++unpaired_;
  newest_depth_ = depth->header.stamp;
  waiting_ = depth;
  return before ? before : pair(true);
}

std::optional<ColoredDepth> ColorPairs::addColor(const sensor_msgs::ImageConstPtr& color)
{
  colors_.push_back(color);
  dropOldest(
      colors_, kMaxColors, [](const auto& image) -> const auto& { return *image; });
  return pair(true);
}

/// The pair of the depth image that waits. With `waits` there is none while a nearer color image is to come.
std::optional<ColoredDepth> ColorPairs::pair(bool waits)
{
  if (!waiting_) return std::nullopt;
  sensor_msgs::ImageConstPtr nearest;
  double least = slop_;
  for (const sensor_msgs::ImageConstPtr& color : colors_)
  {
    const double difference = secondsBetween(color->header.stamp, waiting_->header.stamp);
    if (difference > least) continue;
    nearest = color;
    least = difference;
  }
  if (!nearest || (waits && isNearerToCome(nearest))) return std::nullopt;
  unpaired_ = 0;
  return ColoredDepth{std::exchange(waiting_, nullptr), nearest};
}

/// Whether the next color image is nearer to the depth image that waits, if it comes as long after the newest one as
/// that came after the one before.
bool ColorPairs::isNearerToCome(const sensor_msgs::ImageConstPtr& nearest) const
{
  if (nearest != colors_.back() || colors_.size() < 2) return false;
  const ros::Time& newest = nearest->header.stamp;
  const ros::Time& depth = waiting_->header.stamp;
  if (newest >= depth) return false;
  const double age = secondsBetween(newest, depth);
  return secondsBetween(colors_[colors_.size() - 2]->header.stamp, newest) < 2.0 * age;
}

std::string ColorPairs::problem(const std::string& depth_topic, const std::string& color_topic) const
{
  if (unpaired_ < kMaxUnpaired) return "";
  return "no colors of points for " + std::to_string(unpaired_) + " images: " + reason(depth_topic, color_topic);
}

std::string ColorPairs::reason(const std::string& depth_topic, const std::string& color_topic) const
{
  if (colors_.empty()) return "nothing has come on " + color_topic;
  const ros::Time& oldest = colors_.front()->header.stamp;
  if (colors_.size() == kMaxColors && newest_depth_ < oldest)
    return "the images on " + depth_topic + " come too late: the newest is of " + timeText(newest_depth_) +
           " s, and of those on " + color_topic + " only " + std::to_string(kMaxColors) + " are kept, from " +
           timeText(oldest) + " s on";
  return "the stamps on " + depth_topic + " and " + color_topic + " do not meet: the newest are " +
         timeText(newest_depth_) + " s and " + timeText(colors_.back()->header.stamp) + " s, must be at most slop, " +
         toText(slop_) + " s, apart";
}

void ColorPairs::clear()
{
  colors_.clear();
  waiting_.reset();
  unpaired_ = 0;
}

}  // namespace robot_vision
