#include "color_pairs.hpp"

#include <cmath>
#include <cstdio>
#include <utility>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

std::string timeText(const ros::Time& stamp)
{
  char text[40];
  std::snprintf(text, sizeof(text), "%u.%09u", stamp.sec, stamp.nsec);
  return text;
}

std::size_t bytesOf(const std::deque<sensor_msgs::ImageConstPtr>& images)
{
  std::size_t sum = 0;
  for (const auto& image : images)
    sum += image->data.size();
  return sum;
}

}  // namespace

std::optional<ColoredDepth> ColorPairs::add(const RegisteredDepth& depth)
{
  ++unpaired_;
  newest_depth_ = depth.header.stamp;
  waiting_ = depth;
  return pair();
}

std::optional<ColoredDepth> ColorPairs::add(const sensor_msgs::ImageConstPtr& color)
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
    const double difference = std::abs(color->header.stamp.toSec() - waiting_->header.stamp.toSec());
    if (difference > least) continue;
    nearest = color;
    least = difference;
  }
  if (!nearest) return std::nullopt;
  unpaired_ = 0;
  ColoredDepth found{std::move(*waiting_), nearest};
  waiting_.reset();
  return found;
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
