#include "robot_vision/color/color_range.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>

#include "color_codes.hpp"
#include "core/image/row_bands.hpp"
#include "range_mask.hpp"
#include "robot_vision/color/hsv.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kPart = 1 << 14;  // px that are converted before they are compared, so that they stay in the cache
constexpr int kMaxMargin = 90;
constexpr int kMinSaturation = 100;  // of a first range, as HSV's rangeAround() has it
constexpr int kMinLightness = 50;    // of colours whose value in HSV is 100 and more
constexpr int kMaxLightness = 205;   // of colours whose saturation in HSV is 100 and more
constexpr int kLightFactor = 3;      // how much more than other channels the light changes lightness and luma

bool hasHues(const std::string& space)
{
  return isHue(colorChannels(space)[0]);
}

bool isLight(const ColorChannel& channel)
{
  return channel.meaning == "lightness" || channel.meaning == "luma";
}

HsvRange toHsvRange(const ColorRange& range)
{
  return {range.low[0], range.low[1], range.low[2], range.high[0], range.high[1], range.high[2]};
}

/// Has OpenCV make its tables for Lab, which several threads must not do at the same time, and which take 0.2 s.
void prepareLab()
{
  static const bool prepared = []
  {
    cv::Mat lab;
    cv::cvtColor(cv::Mat(1, 1, CV_8UC3, cv::Scalar::all(0)), lab, cv::COLOR_BGR2Lab);
    return true;
  }();
  static_cast<void>(prepared);
}

}  // namespace

void validate(const ColorRange& range)
{
  const auto channels = colorChannels(range.space);
  for (int i = 0; i < 3; ++i)
  {
    requireRange(channels[i].name + "_low", range.low[i], 0, channels[i].max);
    requireRange(channels[i].name + "_high", range.high[i], isHue(channels[i]) ? 0 : range.low[i], channels[i].max);
  }
}

struct ColorMask::Impl
{
  explicit Impl(const ColorRange& r)
    : range(r),
      through_red(hasHues(r.space) && r.low[0] > r.high[0]),
      from_bgr(colorCode(r.space, false)),
      from_rgb(colorCode(r.space, true))
  {
    if (r.space == "lab") prepareLab();
    if (r.space == "hsv") hsv.emplace(toHsvRange(r));
  }

  ColorRange range;
  bool through_red;
  int from_bgr;
  int from_rgb;
  std::optional<HsvMask> hsv;
};

ColorMask::ColorMask(const ColorRange& range)
{
  validate(range);
  impl_ = std::make_shared<const Impl>(range);
}

void ColorMask::apply(const cv::Mat& image, const std::string& encoding, cv::Mat& mask) const
{
  if (impl_->hsv) return impl_->hsv->apply(image, encoding, mask);
  const bool is_rgb = encoding == "rgb8";
  cv::Mat pixels;
  toEncoding(image, encoding, is_rgb ? "rgb8" : "bgr8", pixels);
  mask.create(pixels.size(), CV_8UC1);
  const int code = is_rgb ? impl_->from_rgb : impl_->from_bgr;
  const int part = rowsOf(kPart, pixels.cols);
  parallelForRows(pixels.rows, cv::getNumThreads(), kMinRows,
                  [&](int, const cv::Range& rows)
                  {
                    cv::Mat converted, rest;
                    for (int y = rows.start; y < rows.end; y += part)
                    {
                      const cv::Range some(y, std::min(y + part, rows.end));
                      const cv::Mat input = pixels.rowRange(some);
                      cv::Mat output = mask.rowRange(some);
                      if (code != kNoColorCode) cv::cvtColor(input, converted, code);
                      findInRange(code == kNoColorCode ? input : converted, impl_->range.low, impl_->range.high,
                                  impl_->through_red, output, rest);
                    }
                  });
}

ColorRange rangeAround(const cv::Vec3b& color, const std::string& space, int margin)
{
  const auto channels = colorChannels(space);
  requireRange("margin", margin, 0, kMaxMargin);
  const bool hues = hasHues(space);
  const HsvRange hue = rangeAround(cv::Vec3b(color[0], 0, 0), margin);
  ColorRange range;
  range.space = space;
  for (int i = 0; i < 3; ++i)
  {
    const int far = isLight(channels[i]) ? kLightFactor * margin : margin;
    range.low[i] = std::max(color[i] - far, 0);
    range.high[i] = std::min(color[i] + far, 255);
    if (isHue(channels[i]))
    {
      range.low[i] = hue.h_low;
      range.high[i] = hue.h_high;
    }
    else if (hues)
    {
      range.low[i] = isLight(channels[i]) ? kMinLightness : kMinSaturation;
      range.high[i] = isLight(channels[i]) ? kMaxLightness : 255;
    }
  }
  if (space == "hls") closeHues(range.low[0], range.high[0]);
  return range;
}

int defaultMargin(const std::string& space)
{
  return hasHues(space) ? 10 : 20;
}

}  // namespace robot_vision
