#include "hsv_tests.hpp"

#include <algorithm>
#include <cmath>

#include "hsv_pixel.hpp"
#include "robot_vision/color/hsv.hpp"

namespace robot_vision
{
namespace
{

constexpr int kHues = 180;
constexpr int kInfiniteMargin = 32000;  // a margin larger than any slack
constexpr int kMaxDiffFactor = 127;     // the largest factor of the difference; times 255 it still fits 16 bits
constexpr int kHueUnit = 60;  // margins of hue are in 1/60 of a gray level, so that the planes have integer factors

/// The smallest difference of the channels (largest minus smallest) that gives a pixel of value `value` the saturation
/// `limit`, or value + 1 if there is none.
int minDifference(int limit, int value)
{
  const int factor = kSaturationFactors[value];
  return factor == 0 ? value + 1 : (minProduct(limit) + factor - 1) / factor;
}

/// A line that separates the pairs (value, difference) at or above the limit from those below, and the slack it needs.
struct FittedLine
{
  SaturationLimit line;
  int slack;
};

/// The line with these factors. `min_difference` has minDifference() for each value.
FittedLine fitLine(const std::array<int, 256>& min_difference, int diff, int value)
{
  int inside = kInfiniteMargin;    // the smallest margin of a pair at or above the limit
  int outside = -kInfiniteMargin;  // the largest margin of a pair below it
  for (int v = 0; v < 256; ++v)
  {
    if (min_difference[v] <= v) inside = std::min(inside, diff * min_difference[v] - value * v);
    outside = std::max(outside, diff * std::min(min_difference[v] - 1, v) - value * v);
  }
  const int offset = inside > outside ? inside : (inside + outside + 1) / 2;
  const int slack = std::max({offset - inside, outside - offset + 1, 0});
  const SaturationLimit line = {static_cast<std::int16_t>(diff), static_cast<std::int16_t>(value),
                                static_cast<std::int16_t>(offset)};
  return {line, slack};
}

std::int16_t larger(std::int16_t a, int b)
{
  return static_cast<std::int16_t>(std::max<int>(a, b));
}

}  // namespace

HsvTests::HsvTests(const HsvRange& range)
{
  s_low = saturationLimit(range.s_low);
  s_above = saturationLimit(range.s_high + 1);
  setHue(range);
  // Black has no saturation, but lies on every line. It is excluded by its value.
  v_low = static_cast<std::uint8_t>(range.s_low > 0 ? std::max(range.v_low, 1) : range.v_low);
  v_high = static_cast<std::uint8_t>(range.v_high);
}

/// The line whose slack is the smallest, measured in gray levels.
SaturationLimit HsvTests::saturationLimit(int limit)
{
  if (limit == 0) return {0, 0, -kInfiniteMargin};
  if (limit == 256) return {0, 0, kInfiniteMargin};
  std::array<int, 256> min_difference;
  for (int v = 0; v < 256; ++v)
    min_difference[v] = minDifference(limit, v);

  const double slope = (limit - 0.5) / 255.0;
  FittedLine best = fitLine(min_difference, kMaxDiffFactor, static_cast<int>(std::lround(slope * kMaxDiffFactor)));
  for (int diff = kMaxDiffFactor - 1; diff > 0 && best.slack > 0; --diff)
  {
    const FittedLine fitted = fitLine(min_difference, diff, static_cast<int>(std::lround(slope * diff)));
    if (fitted.slack * best.line.diff < best.slack * diff) best = fitted;
  }
  s_slack = larger(s_slack, best.slack);
  return best.line;
}

void HsvTests::setHue(const HsvRange& range)
{
  const bool empty = range.h_low == kHues && range.h_high == kHues;
  const int low = range.h_low % kHues;
  const int high = std::min(range.h_high, kHues - 1);
  const int hues = empty ? 0 : (high - low + kHues) % kHues + 1;
  if (empty || hues == kHues)
  {
    h_low.offset = h_above.offset = 1;  // no pixel is inside of such a wedge
    h_outside = empty ? 0 : -1;
    return;
  }
  const int above = (high + 1) % kHues;
  const bool gray_inside = low == 0 || low > high;  // OpenCV gives gray the hue 0
  // The wedge is the smaller of the range and its rest. If both are halves, one plane limits both, which must have no
  // offset if gray is inside.
  const bool narrow = 2 * hues < kHues || (2 * hues == kHues && gray_inside);
  h_outside = narrow ? 0 : -1;
  h_low = hueLimit(narrow ? low : above, gray_inside == narrow);
  h_above = hueLimit(narrow ? above : low, false);
}

/// The plane of the colours half a step below the hue `limit` (0 to 179), which is never on the border of two sextants.
/// Gray, which lies on all these planes, gets the margin 0 if `gray_inside`, else -1.
HueLimit HsvTests::hueLimit(int limit, bool gray_inside)
{
  struct Sextant
  {
    int max, mid, min;  // channels in the order of their values
  };
  constexpr std::array<Sextant, 6> kSextants = {{{2, 1, 0}, {1, 2, 0}, {1, 0, 2}, {0, 1, 2}, {0, 2, 1}, {2, 0, 1}}};
  const int number = limit == 0 ? 5 : (2 * limit - 1) / 60;
  const Sextant& sextant = kSextants[number];

  // Within a sextant the hue is axis +- 30 * (mid - min) / (max - min).
  const int axis = (number + 1) / 2 * 60;
  const int twice_limit = 2 * (limit == 0 ? kHues : limit) - 1;
  const int mid = number % 2 == 0 ? kHueUnit : -kHueUnit;
  const int max = 2 * axis - twice_limit;
  HueLimit plane;
  plane.channels[sextant.max] = static_cast<std::int16_t>(max);
  plane.channels[sextant.mid] = static_cast<std::int16_t>(mid);
  plane.channels[sextant.min] = static_cast<std::int16_t>(-max - mid);
  plane.offset = gray_inside ? 0 : 1;

  // The slack depends on the smallest numerator in OpenCV's division that reaches the limit, for each difference of the
  // channels. Numerators are negative in the last sextant.
  const int signed_limit = number == 5 && limit > 0 ? limit - kHues : limit;
  for (int diff = 1; diff < 256; ++diff)
  {
    const int numerator = static_cast<int>(std::ceil(minProduct(signed_limit) / double(kHueFactors[diff])));
    const int inside = kHueUnit * numerator - (2 * signed_limit - 1) * diff - plane.offset;
    const int slack = std::max({-inside, inside - kHueUnit + 1, 0});
    h_slack = larger(h_slack, (256 * slack - 255 + diff - 1) / diff);
  }
  return plane;
}

}  // namespace robot_vision
