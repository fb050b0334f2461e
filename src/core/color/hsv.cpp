#include "robot_vision/color/hsv.hpp"

#include <algorithm>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/image/row_bands.hpp"
#include "hsv_kernels.hpp"
#include "hsv_pixel.hpp"
#include "hsv_tests.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

bool isInside(const cv::Vec3b& hsv, const HsvRange& range)
{
  const int h = hsv[0];
  const bool h_inside =
      range.h_low <= range.h_high ? range.h_low <= h && h <= range.h_high : range.h_low <= h || h <= range.h_high;
  return h_inside && range.s_low <= hsv[1] && hsv[1] <= range.s_high && range.v_low <= hsv[2] && hsv[2] <= range.v_high;
}

/// Decides by their HSV about the pixels that the tests have left undecided.
void decideRemaining(const cv::Vec3b* row, std::uint8_t* mask, int count, bool is_rgb, const HsvRange& range)
{
  std::uint8_t* const end = mask + count;
  std::uint8_t* pixel = mask;
  const auto find = [&]
  { return static_cast<std::uint8_t*>(std::memchr(pixel, kUndecided, std::size_t(end - pixel))); };
  while ((pixel = find()) != nullptr)
    for (; pixel != end && *pixel == kUndecided; ++pixel)  // they are often neighbours
    {
      const cv::Vec3b& color = row[pixel - mask];
      const cv::Vec3b bgr = is_rgb ? cv::Vec3b(color[2], color[1], color[0]) : color;
      *pixel = isInside(toHsv(bgr), range) ? 255 : 0;
    }
}

HsvTests forRgb(HsvTests tests)
{
  for (HueLimit* limit : {&tests.h_low, &tests.h_above})
    std::swap(limit->channels[0], limit->channels[2]);
  return tests;
}

}  // namespace

void validate(const HsvRange& range)
{
  checkFields(range);
  requireRange("s_high", range.s_high, range.s_low, 255);
  requireRange("v_high", range.v_high, range.v_low, 255);
}

struct HsvMask::Impl
{
  explicit Impl(const HsvRange& r) : range(r), bgr(r), rgb(forRgb(bgr)) {}

  HsvRange range;
  HsvTests bgr;
  HsvTests rgb;
};

HsvMask::HsvMask(const HsvRange& range)
{
  validate(range);
  impl_ = std::make_shared<const Impl>(range);
}

void HsvMask::apply(const cv::Mat& image, const std::string& encoding, cv::Mat& mask) const
{
  const bool is_rgb = encoding == "rgb8";
  cv::Mat pixels;
  toEncoding(image, encoding, is_rgb ? "rgb8" : "bgr8", pixels);
  mask.create(pixels.size(), CV_8UC1);
  const HsvTests& tests = is_rgb ? impl_->rgb : impl_->bgr;
  const auto test = kernels<HsvKernels>().hsv;
  parallelForRows(pixels.rows, cv::getNumThreads(), kMinRows,
                  [&](int, const cv::Range& rows)
                  {
                    for (int y = rows.start; y < rows.end; ++y)
                    {
                      const auto* row = pixels.ptr<cv::Vec3b>(y);
                      test(tests, row->val, mask.cols, mask.ptr(y));
                      decideRemaining(row, mask.ptr(y), mask.cols, is_rgb, impl_->range);
                    }
                  });
}

HsvRange rangeAround(const cv::Vec3b& hsv, int margin)
{
  requireRange("margin", margin, 0, 90);
  const bool all = margin == 90;
  HsvRange range;
  range.h_low = all ? 0 : (hsv[0] + 180 - margin) % 180;
  range.h_high = all ? 179 : (hsv[0] + margin) % 180;
  range.s_low = range.v_low = 100;
  range.s_high = range.v_high = 255;
  return range;
}

cv::Vec3b toHsv(const cv::Vec3b& bgr)
{
  const int b = bgr[0], g = bgr[1], r = bgr[2];
  const int max = std::max({b, g, r});
  const int diff = max - std::min({b, g, r});
  const int s = roundedProduct(diff, kSaturationFactors[max]);
  const int numerator = max == r ? g - b : max == g ? b - r + 2 * diff : r - g + 4 * diff;
  const int h = roundedProduct(numerator, kHueFactors[diff]);
  return {static_cast<std::uint8_t>(h < 0 ? h + 180 : h), static_cast<std::uint8_t>(s), static_cast<std::uint8_t>(max)};
}

cv::Vec3b bgrOfHsv(const cv::Vec3b& hsv)
{
  const cv::Mat3b pixel(1, 1, hsv);
  cv::Mat3b bgr;
  cv::cvtColor(pixel, bgr, cv::COLOR_HSV2BGR);
  return bgr(0, 0);
}

}  // namespace robot_vision
