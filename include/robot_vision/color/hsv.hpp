#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

/// A range of colours in 8-bit HSV as OpenCV has it, limits included. h_low above h_high: the range goes through red,
/// from h_low to 179 and on from 0 to h_high.
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

/// The pixels of a picture whose colour is in a range: cv::cvtColor to HSV and cv::inRange (for a range through red the
/// union of two), to the bit, in one pass without the HSV picture, by as many threads as cv::setNumThreads() says.
/// Never changes: threads may share one.
class HsvMask
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit HsvMask(const HsvRange& range = HsvRange());

  /// Writes CV_8UC1, 255 inside the range and 0 elsewhere, into `mask` (reused if it fits). `image` is not modified;
  /// bgr8 and rgb8 are read as they are, all else is converted to bgr8 first (see toBgr in encoding.hpp).
  /// Throws std::invalid_argument if `image` is not a picture of `encoding`.
  void apply(const cv::Mat& image, const std::string& encoding, cv::Mat& mask) const;

private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// The range to begin with for a colour picked from a picture: its hue (half degrees, taken modulo 180) and `margin`
/// more and less, 0 to 90, through red where it must; saturation and value from 100 to 255: light changes these. Throws
/// std::invalid_argument naming margin if it is out of range.
HsvRange rangeAround(const cv::Vec3b& hsv, int margin = 10);

/// One colour as cv::cvtColor with COLOR_BGR2HSV converts it: hue in half degrees 0 to 179, saturation, value.
cv::Vec3b toHsv(const cv::Vec3b& bgr);

}  // namespace robot_vision
