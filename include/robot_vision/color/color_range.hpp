#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/color/color_space.hpp"

namespace robot_vision
{

/// A range of colours in one of colorSpaces(), limits included: those of the channels in the order of the space's name.
/// Of hues the low one may be above the high one: from the low one through red to the high one.
struct ColorRange
{
  std::string space = "hsv";
  cv::Vec3i low = {90, 50, 50};  // 0 to 255; hues to 180, half degrees
  cv::Vec3i high = {120, 255, 255};
};

/// Throws std::invalid_argument naming the space if it is none, or the first limit out of range, as h_low or cr_high,
/// its value and the range.
void validate(const ColorRange& range);

/// Finds the pixels whose colour is in a range, bit for bit as cv::cvtColor to its space followed by cv::inRange does
/// (the union of two for a range through red). HSV is that of HsvMask. The rest is converted in parts that fit into a
/// processor's cache, by as many threads as cv::setNumThreads() allows. Threads may share a ColorMask, because it never
/// changes.
class ColorMask
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit ColorMask(const ColorRange& range = ColorRange());

  /// Writes CV_8UC1, 255 inside the range and 0 elsewhere, into `mask` (reused if it fits). `image` is not modified;
  /// bgr8 and rgb8 are read as they are, other encodings are converted to bgr8 first (see toBgr() in encoding.hpp).
  /// Throws std::invalid_argument if `image` is not of `encoding`.
  void apply(const cv::Mat& image, const std::string& encoding, cv::Mat& mask) const;

private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// A first range in a space for a colour of that space that was picked from an image. Hues are those up to `margin` (0
/// to 90) from the colour's, through red if necessary; of a space with hues saturation and value are from 100 to 255,
/// and the lightness from 50 to 205. In other spaces channels are up to `margin` from the colour's, lightness and luma
/// up to three times as far, because they change with the light. Throws std::invalid_argument if the space is none or
/// `margin` is out of range.
ColorRange rangeAround(const cv::Vec3b& color, const std::string& space, int margin);

/// What to take for `margin` if nothing else is known: 10 half degrees in spaces with hues, and 20 in others.
int defaultMargin(const std::string& space);

/// The smallest range in another space that holds all colours of a range, found by looking at all that there are in 8
/// bits, which takes some tenths of a second. Throws std::invalid_argument as validate() does, if `space` is none, or
/// if the range holds no colour at all.
ColorRange convertRange(const ColorRange& range, const std::string& space);

}  // namespace robot_vision
