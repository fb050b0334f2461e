#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

/// A range of colours in OpenCV's 8-bit HSV, limits included. If h_low is above h_high the range goes through red: from
/// h_low to 179, and from 0 to h_high.
struct HsvRange
{
  int h_low = 90;
  int s_low = 50;
  int v_low = 50;
  int h_high = 120;
  int s_high = 255;
  int v_high = 255;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("h_low", &HsvRange::h_low, Range{0, 180}, "half degrees", "lowest hue; above h_high: through red");
    visit("s_low", &HsvRange::s_low, Range{0, 255}, "", "lowest saturation");
    visit("v_low", &HsvRange::v_low, Range{0, 255}, "", "lowest value");
    visit("h_high", &HsvRange::h_high, Range{0, 180}, "half degrees", "highest hue; no pixel has 180");
    visit("s_high", &HsvRange::s_high, Range{0, 255}, "", "highest saturation, s_low or more");
    visit("v_high", &HsvRange::v_high, Range{0, 255}, "", "highest value, v_low or more");
  }
};

/// Throws std::invalid_argument naming the first limit out of range, its value and the range.
void validate(const HsvRange& range);

/// Finds the pixels whose colour is in a range, bit for bit as cv::cvtColor to HSV followed by cv::inRange does (the
/// union of two for a range through red). It takes one pass, computes no HSV image, and uses as many threads as
/// cv::setNumThreads() allows. Threads may share an HsvMask, because it never changes.
class HsvMask
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit HsvMask(const HsvRange& range = HsvRange());

  /// Writes CV_8UC1, 255 inside the range and 0 elsewhere, into `mask` (reused if it fits). `image` is not modified;
  /// bgr8 and rgb8 are read as they are, other encodings are converted to bgr8 first (see toBgr() in encoding.hpp).
  /// Throws std::invalid_argument if `image` is not of `encoding`.
  void apply(const cv::Mat& image, const std::string& encoding, cv::Mat& mask) const;

private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// A first range for a colour that was picked from an image. The hues (half degrees, modulo 180) are those up to
/// `margin` (0 to 90) from the colour's, through red if necessary. Saturation and value, which change with the light,
/// are from 100 to 255. Throws std::invalid_argument if `margin` is out of range.
HsvRange rangeAround(const cv::Vec3b& hsv, int margin = 10);

/// Converts a colour as cv::cvtColor with COLOR_BGR2HSV does: hue in half degrees (0 to 179), saturation, value.
cv::Vec3b toHsv(const cv::Vec3b& bgr);

/// A colour that has this HSV as nearly as 8 bits allow, as cv::cvtColor converts it.
cv::Vec3b bgrOfHsv(const cv::Vec3b& hsv);

}  // namespace robot_vision
