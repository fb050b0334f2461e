#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "color_codes.hpp"
#include "robot_vision/color/color_range.hpp"

namespace robot_vision
{
namespace
{

constexpr int kValues = 256;  // of a channel
constexpr int kHues = 180;

using Seen = std::array<bool, kValues>;  // which values of a channel there are

/// The lowest and the highest value that there are. Of hues, which lie on a circle, those beside the widest gap.
std::pair<int, int> limitsOf(const Seen& seen)
{
  const auto first = std::find(seen.begin(), seen.end(), true);
  const auto last = std::find(seen.rbegin(), seen.rend(), true);
  return {static_cast<int>(first - seen.begin()), static_cast<int>(seen.rend() - last) - 1};
}

std::pair<int, int> hueLimitsOf(Seen seen)
{
  const bool rounded = seen[kHues];
  seen[0] = seen[0] || rounded;
  seen[kHues] = false;
  auto [low, high] = limitsOf(seen);
  int widest = low + kHues - high;  // through red
  for (int from = low, to = low + 1; to <= high; ++to)
  {
    if (!seen[to]) continue;
    if (to - from > widest)
    {
      widest = to - from;
      low = to;
      high = from;
    }
    from = to;
  }
  if (rounded) closeHues(low, high);
  return {low, high};
}

/// The colours that have one value of blue: rows of green, columns of red.
cv::Mat_<cv::Vec3b> colorsOf(int blue)
{
  cv::Mat_<cv::Vec3b> colors(kValues, kValues);
  for (int green = 0; green < kValues; ++green)
    for (int red = 0; red < kValues; ++red)
      colors(green, red) =
          cv::Vec3b(static_cast<std::uint8_t>(blue), static_cast<std::uint8_t>(green), static_cast<std::uint8_t>(red));
  return colors;
}

/// Marks the values of the pixels where the mask is set.
void note(const cv::Mat_<cv::Vec3b>& colors, const cv::Mat_<std::uint8_t>& mask, std::array<Seen, 3>& seen)
{
  for (int y = 0; y < colors.rows; ++y)
    for (int x = 0; x < colors.cols; ++x)
      if (mask(y, x) != 0)
        for (int i = 0; i < 3; ++i)
          seen[i][colors(y, x)[i]] = true;
}

}  // namespace

ColorRange convertRange(const ColorRange& range, const std::string& space)
{
  const ColorMask inside(range);
  const auto channels = colorChannels(space);
  std::array<Seen, 3> seen = {};
  cv::Mat mask, converted;
  for (int blue = 0; blue < kValues; ++blue)
  {
    const cv::Mat_<cv::Vec3b> colors = colorsOf(blue);
    inside.apply(colors, "bgr8", mask);
    if (cv::countNonZero(mask) == 0) continue;
    toSpace(colors, "bgr8", space, converted);
    note(converted, mask, seen);
  }
  if (std::find(seen[0].begin(), seen[0].end(), true) == seen[0].end())
    throw std::invalid_argument("the range holds no colour, so that there is none to look for in " + space);
  ColorRange found;
  found.space = space;
  for (int i = 0; i < 3; ++i)
    std::tie(found.low[i], found.high[i]) = isHue(channels[i]) ? hueLimitsOf(seen[i]) : limitsOf(seen[i]);
  return found;
}

}  // namespace robot_vision
