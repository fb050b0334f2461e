#include "changed_pixels.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

#include "rects.hpp"

namespace robot_vision
{
namespace
{

constexpr int kBlock = 64;  // px of a row that are looked at together

/// Whether any of two runs of pixels differ by more than `threshold`.
bool differ(const std::uint8_t* a, const std::uint8_t* b, int count, std::uint8_t threshold)
{
  int i = 0;
#if CV_SIMD128
  constexpr int kLanes = 16;
  std::uint8_t lanes[kLanes];
  cv::v_uint8x16 largest = cv::v_setzero_u8();
  for (; i + kLanes <= count; i += kLanes)
    largest = cv::v_max(largest, cv::v_absdiff(cv::v_load(a + i), cv::v_load(b + i)));
  cv::v_store(lanes, largest);
  if (*std::max_element(lanes, lanes + kLanes) > threshold) return true;
#endif
  for (; i < count; ++i)
    if (std::abs(a[i] - b[i]) > threshold) return true;
  return false;
}

/// A rectangle around all pixels that differ by more than `threshold`.
cv::Rect boxOfDifferences(const cv::Mat& a, const cv::Mat& b, double threshold)
{
  const auto whole = static_cast<std::uint8_t>(threshold);  // more than 25.5 is more than 25, between whole numbers
  cv::Rect box;
  for (int y = 0; y < a.rows; ++y)
    for (int x = 0; x < a.cols; x += kBlock)
    {
      const int count = std::min(kBlock, a.cols - x);
      if (differ(a.ptr(y) + x, b.ptr(y) + x, count, whole)) box |= cv::Rect(x, y, count, 1);
    }
  return box;
}

/// `picture` blurred, within `part`; to the bit as if all of it were.
cv::Mat blurPart(const cv::Mat& picture, const cv::Rect& part, int blur_size)
{
  const cv::Rect outer = grown(part, blur_size / 2, picture.size());
  // A copy: cv::GaussianBlur is exact for whole pictures only. What is invented beyond its border stays out of `part`.
  return blurred(picture(outer).clone(), blur_size)(part - outer.tl());
}

}  // namespace

cv::Mat blurred(const cv::Mat& picture, int blur_size)
{
  cv::Mat result;
  cv::GaussianBlur(picture, result, {blur_size, blur_size}, 0.0);
  return result;
}

cv::Rect findChangedPixels(const cv::Mat& gray, const Reference& reference, int blur_size, double threshold,
                           cv::Mat& mask)
{
  mask.create(gray.size(), CV_8UC1);
  mask.setTo(0);
  // Means of pixels that differ by whole numbers up to the threshold do so too, also when they are rounded.
  const cv::Rect part = grown(boxOfDifferences(gray, reference.picture, threshold), blur_size / 2, gray.size());
  if (part.empty()) return part;
  const cv::Mat background =
      reference.blurred.empty() ? blurPart(reference.picture, part, blur_size) : reference.blurred(part);
  cv::Mat difference;
  cv::absdiff(blurPart(gray, part, blur_size), background, difference);
  cv::threshold(difference, mask(part), threshold, 255.0, cv::THRESH_BINARY);
  return part;
}

}  // namespace robot_vision
