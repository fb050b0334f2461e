#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// An image in HSV, and where its hues can be told.
struct HsvPixels
{
  /// `bgr` is CV_8UC3. Pixels below `min_saturation` or `min_value` are not in the mask.
  HsvPixels(const cv::Mat& bgr, int min_saturation, int min_value);

  /// The same of a part of the image, without a copy.
  HsvPixels operator()(const cv::Rect& part) const;

  /// The histogram of hue and saturation: CV_32FC1, a row for each bin of the hue.
  cv::Mat histogram(int hue_bins, int saturation_bins) const;

  /// How frequent each pixel's colour is in such a histogram: CV_8UC1, 255 for the most frequent one, 0 outside of the
  /// mask. `out` is reused if it fits.
  void backProject(const cv::Mat& histogram, cv::Mat& out) const;

  cv::Mat hsv;   // CV_8UC3
  cv::Mat mask;  // CV_8UC1; empty: everywhere

private:
  HsvPixels() = default;
};

}  // namespace robot_vision
