#pragma once

#include <sensor_msgs/Image.h>
#include <std_msgs/Header.h>

#include <cstddef>
#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

namespace robot_vision
{

/// A depth image that waits for its colors.
struct RegisteredDepth
{
  std_msgs::Header header;
  cv::Mat pixels;
  std::string encoding;
};

/// A depth image and the color image of about the same time.
struct ColoredDepth
{
  RegisteredDepth depth;
  sensor_msgs::ImageConstPtr color;
};

/// Finds the color image of each depth image by their stamps, whichever comes first: the nearest of those that are
/// there and differ by `slop` (s) at most, or else the first one that comes before the next depth image. Keeps few
/// images. Not thread-safe.
class ColorPairs
{
public:
  static constexpr std::size_t kMaxColors = 4;                    // that are kept
  static constexpr std::size_t kMaxBytes = std::size_t{1} << 27;  // of these, or one image
  static constexpr std::size_t kMaxUnpaired = 20;  // depth images in a row without one, until that is told

  explicit ColorPairs(double slop) : slop_(slop) {}

  /// Adds an image. Returns the pair that it makes complete.
  std::optional<ColoredDepth> add(const RegisteredDepth& depth);
  std::optional<ColoredDepth> add(const sensor_msgs::ImageConstPtr& color);

  /// Why there are no pairs, in one line that names topics, each time that so many depth images have found none;
  /// otherwise empty.
  std::string problem(const std::string& depth_topic, const std::string& color_topic);

  /// Forgets all images.
  void clear();

private:
  std::optional<ColoredDepth> pair();

  double slop_;
  std::deque<sensor_msgs::ImageConstPtr> colors_;
  std::optional<RegisteredDepth> waiting_;
  ros::Time newest_depth_;
  std::size_t unpaired_ = 0;
};

}  // namespace robot_vision
