#pragma once

#include <cstdint>

namespace robot_vision
{

struct HsvRange;

/// A limit of the saturation as a line. Its margin is diff * (max - min) - value * max - offset, where max and min are
/// the largest and the smallest of the pixel's channels. A margin of at least the slack proves that the saturation is
/// at or above the limit, one below -slack that it is below.
struct SaturationLimit
{
  std::int16_t diff = 0;
  std::int16_t value = 0;
  std::int16_t offset = 0;
};

/// A limit of the hue as a plane through the gray axis. Its margin is channels * (b, g, r) - offset, which is positive
/// for the 90 half degrees that follow the limit. The factors of the channels add up to 0.
struct HueLimit
{
  std::int16_t channels[3] = {};  // no std::array, because the kernels must not call functions of headers
  std::int16_t offset = 0;
};

/// Tests whether a pixel is in a range of HSV, by 16-bit integers and without a division.
///
/// OpenCV divides by tables of rounded reciprocals, which such tests cannot reproduce to the bit. Each test therefore
/// has a margin and a slack: a margin of at least the slack proves that the pixel is inside, one below -slack that it
/// is outside. Pixels in between, one in some hundreds, must be converted. All factors and slacks fit signed bytes, and
/// so do sums of two channels' factors.
struct HsvTests
{
  explicit HsvTests(const HsvRange& range);

  SaturationLimit s_low;
  SaturationLimit s_above;     // the first saturation that is too high
  std::int16_t s_slack = 0;    // of both limits
  HueLimit h_low;              // the first hue of a wedge of at most 90 half degrees, which is the range or its rest
  HueLimit h_above;            // the first hue after the wedge
  std::int16_t h_outside = 0;  // -1 if the range is outside of the wedge, else 0
  std::int16_t h_slack = 0;    // both limits have the slack (h_slack * (max - min) + 255) >> 8
  std::uint8_t v_low = 0;
  std::uint8_t v_high = 255;

private:
  void setHue(const HsvRange& range);
  SaturationLimit saturationLimit(int limit);
  HueLimit hueLimit(int limit, bool gray_inside);
};

}  // namespace robot_vision
