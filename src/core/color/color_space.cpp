#include "robot_vision/color/color_space.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "color_codes.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kHues = 180;     // half degrees
constexpr int kRowOfOne = 64;  // px; so many of one colour are converted by vectors, as the middle of an image is

struct Space
{
  const char* name;
  int from_bgr;
  int from_rgb;
  std::array<ColorChannel, 3> channels;
};

const std::array<Space, 6>& spaces()
{
  static const std::array<Space, 6> kSpaces = {{
      {"hsv",
       cv::COLOR_BGR2HSV,
       cv::COLOR_RGB2HSV,
       {{{"h", "hue", kHues}, {"s", "saturation", 255}, {"v", "value", 255}}}},
      {"hls",
       cv::COLOR_BGR2HLS,
       cv::COLOR_RGB2HLS,
       {{{"h", "hue", kHues}, {"l", "lightness", 255}, {"s", "saturation", 255}}}},
      {"lab",
       cv::COLOR_BGR2Lab,
       cv::COLOR_RGB2Lab,
       {{{"l", "lightness", 255}, {"a", "green to red", 255}, {"b", "blue to yellow", 255}}}},
      {"ycrcb",
       cv::COLOR_BGR2YCrCb,
       cv::COLOR_RGB2YCrCb,
       {{{"y", "luma", 255}, {"cr", "red difference", 255}, {"cb", "blue difference", 255}}}},
      {"rgb", cv::COLOR_BGR2RGB, kNoColorCode, {{{"r", "red", 255}, {"g", "green", 255}, {"b", "blue", 255}}}},
      {"bgr", kNoColorCode, cv::COLOR_RGB2BGR, {{{"b", "blue", 255}, {"g", "green", 255}, {"r", "red", 255}}}},
  }};
  return kSpaces;
}

const Space& spaceOf(const std::string& name)
{
  const auto* found = std::find_if(spaces().begin(), spaces().end(), [&](const Space& s) { return name == s.name; });
  require(found != spaces().end(), "space", "'" + printable(name) + "'", "one of " + joined(colorSpaces()));
  return *found;
}

}  // namespace

std::vector<std::string> colorSpaces()
{
  std::vector<std::string> names;
  for (const Space& space : spaces())
    names.emplace_back(space.name);
  return names;
}

std::array<ColorChannel, 3> colorChannels(const std::string& space)
{
  return spaceOf(space).channels;
}

bool isHue(const ColorChannel& channel)
{
  return channel.max == kHues;
}

int colorCode(const std::string& space, bool is_rgb)
{
  const Space& found = spaceOf(space);
  return is_rgb ? found.from_rgb : found.from_bgr;
}

void closeHues(int& low, int& high)
{
  if (low != 0) return;
  (high < kHues - 1 ? low : high) = kHues;
}

cv::Vec3b toSpace(const cv::Vec3b& bgr, const std::string& space)
{
  const int code = colorCode(space, false);
  if (code == kNoColorCode) return bgr;
  const cv::Mat_<cv::Vec3b> row(1, kRowOfOne, bgr);
  cv::Mat_<cv::Vec3b> converted;
  cv::cvtColor(row, converted, code);
  return converted(0, 0);
}

void toSpace(const cv::Mat& image, const std::string& encoding, const std::string& space, cv::Mat& out)
{
  const bool is_rgb = encoding == "rgb8";
  const int code = colorCode(space, is_rgb);
  cv::Mat pixels;
  toEncoding(image, encoding, is_rgb ? "rgb8" : "bgr8", pixels);
  if (code == kNoColorCode)
    out = pixels;
  else
    cv::cvtColor(pixels, out, code);
}

}  // namespace robot_vision
