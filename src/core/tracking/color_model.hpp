#pragma once

#include <opencv2/core.hpp>

#include "core/histogram/hsv_histogram.hpp"
#include "robot_vision/tracking/window_tracker.hpp"

namespace robot_vision
{

/// The colours of a selected object, and of what was around it.
class ColorModel
{
public:
  /// Copies what it needs of `bgr` (CV_8UC3); `region` is inside of it.
  ColorModel(const cv::Mat& bgr, const cv::Rect& region, const WindowTrackerParams& params);

  /// Counts the colours anew, with other bins or limits.
  void configure(const WindowTrackerParams& params);

  /// How frequent the colour of each pixel is in the object: CV_8UC1, in new memory.
  cv::Mat backProject(const cv::Mat& bgr) const;

  /// px, of the region.
  cv::Size size() const { return region_.size(); }

private:
  cv::Mat around_;   // CV_8UC3, the region with its surroundings
  cv::Rect region_;  // px in these
  cv::Mat histogram_;
  int min_saturation_ = 0;
  int min_value_ = 0;
};

}  // namespace robot_vision
