#pragma once

#include <cstdint>

namespace robot_vision
{

struct HsvRange;

/// A limit of the saturation as a line: diff * (max - min) - value * max - offset is its margin, where max and min are
/// those of the pixel's three channels. At least `slack`: at or above the limit; below -slack: under it.
struct SaturationLimit
{
  std::int16_t diff = 0;
  std::int16_t value = 0;
  std::int16_t offset = 0;
};

/// A limit of the hue as a plane through the gray axis: channels * (b, g, r) - offset is its margin, positive on the
/// side of the 90 half degrees that follow the limit. The channels' factors add up to 0.
struct HueLimit
{
  std::int16_t channels[3] = {};  // no std::array: the kernels may call no function of a header
  std::int16_t offset = 0;
};

/// A range of HSV as integer tests that fit 16 bits and need no division.
///
/// OpenCV divides with tables of rounded reciprocals, which no such test can follow to the bit. So each has a margin
/// and a slack, such that a margin of at least the slack proves the pixel to be inside and one below -slack to be
/// outside. What is between, one pixel in some hundreds, has to be converted. Factors and slacks fit signed bytes,
/// those of two channels together, too.
struct HsvTests
{
  explicit HsvTests(const HsvRange& range);

  SaturationLimit s_low;
  SaturationLimit s_above;     // the first saturation that is too high
  std::int16_t s_slack = 0;    // of both
  HueLimit h_low;              // with h_above, of the wedge of at most 90 half degrees that is the range or its rest
  HueLimit h_above;            // the first hue after the wedge
  std::int16_t h_outside = 0;  // -1: the range is what is outside the wedge; else 0
  std::int16_t h_slack = 0;    // of both: (h_slack * (max - min) + 255) >> 8, as the error grows with the difference
  std::uint8_t v_low = 0;
  std::uint8_t v_high = 255;

private:
  void setSaturation(const HsvRange& range);
  void setHue(const HsvRange& range);
  SaturationLimit saturationLimit(int limit);
  HueLimit hueLimit(int limit, bool grey_inside);
};

}  // namespace robot_vision
