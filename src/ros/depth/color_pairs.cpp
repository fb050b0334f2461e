#include "color_pairs.hpp"

#include <utility>

#include "robot_vision/common/range.hpp"
#include "ros/images/stamps.hpp"

namespace robot_vision
{
std::optional<ColoredDepth> ColorPairs::addDepth(const sensor_msgs::ImageConstPtr& depth)
{
  ++unpaired_;
  newest_depth_ = depth->header.stamp;
  waiting_ = depth;
  return pair();
}

std::optional<ColoredDepth> ColorPairs::addColor(const sensor_msgs::ImageConstPtr& color)
{
  colors_.push_back(color);
  while (colors_.size() > kMaxColors || (colors_.size() > 1 && bytesOf(colors_) > kMaxBytes))
    colors_.pop_front();
  return pair();
}

std::optional<ColoredDepth> ColorPairs::pair()
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
  if (!nearest) return std::nullopt;
  unpaired_ = 0;
  return ColoredDepth{std::exchange(waiting_, nullptr), nearest};
}

std::string ColorPairs::problem(const std::string& depth_topic, const std::string& color_topic)
{
  if (unpaired_ < kMaxUnpaired) return "";
  unpaired_ = 0;
  if (colors_.empty()) return "nothing has come on " + color_topic;
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
