#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

namespace robot_vision
{

/// A range of colours in 8-bit HSV as OpenCV has it, limits included. h_low above h_high: the range goes through red,
/// from h_low to 179 and on from 0 to h_high.
struct HsvRange
{
  int h_low = 90;    // half degrees, 0 to 180 (no pixel has 180)
  int s_low = 50;    // saturation, 0 to 255
  int v_low = 50;    // value, 0 to 255
  int h_high = 120;  // half degrees, 0 to 180
  int s_high = 255;  // s_low to 255
  int v_high = 255;  // v_low to 255
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
