#pragma once

#include <sensor_msgs/Image.h>

#include <cstddef>
#include <deque>
#include <optional>
#include <string>

namespace robot_vision
{

/// A depth image and the color image of about the same time.
struct ColoredDepth
{
  sensor_msgs::ImageConstPtr depth, color;
};

/// Finds the color image of each depth image by their stamps, whichever comes first: the nearest of those that differ
/// by `slop` (s) at most. It waits for a nearer one if that is to come next, but no longer than for the next depth
/// image. Keeps few images. Not thread-safe.
class ColorPairs
{
public:
  static constexpr std::size_t kMaxColors = 4;     // that are kept
  static constexpr std::size_t kMaxUnpaired = 20;  // depth images in a row without one, until that is told

  explicit ColorPairs(double slop) : slop_(slop) {}

  /// Adds an image. Returns the pair that it makes complete.
  std::optional<ColoredDepth> addDepth(const sensor_msgs::ImageConstPtr& depth);
  std::optional<ColoredDepth> addColor(const sensor_msgs::ImageConstPtr& color);

  /// Since how many depth images there are no colors, and why, in one line that names topics; empty until so many in a
  /// row have found none.
  std::string problem(const std::string& depth_topic, const std::string& color_topic) const;

  /// Forgets all images.
  void clear();

private:
  std::string reason(const std::string& depth_topic, const std::string& color_topic) const;
  std::optional<ColoredDepth> pair(bool waits);
  bool isNearerToCome(const sensor_msgs::ImageConstPtr& nearest) const;

  double slop_;
  std::deque<sensor_msgs::ImageConstPtr> colors_;
  sensor_msgs::ImageConstPtr waiting_;  // the last depth image, until it has its colors
  ros::Time newest_depth_;
  std::size_t unpaired_ = 0;  // depth images since the last pair
};

}  // namespace robot_vision
