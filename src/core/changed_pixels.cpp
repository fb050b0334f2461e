#include "changed_pixels.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

#include "rects.hpp"
#include "robot_vision/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kBlock = 64;  // px of a row that are looked at together

/// Whether any of two runs of bytes differ by more than `threshold`.
bool differ(const std::uint8_t* a, const std::uint8_t* b, int count, std::uint8_t threshold)
{
  int i = 0;
#if CV_SIMD128
  constexpr int kLanes = 16;
  cv::v_uint8x16 largest = cv::v_setzero_u8();
  for (; i + kLanes <= count; i += kLanes)
    largest = cv::v_max(largest, cv::v_absdiff(cv::v_load(a + i), cv::v_load(b + i)));
  if (cv::v_check_any(largest > cv::v_setall_u8(threshold))) return true;
#endif
  for (; i < count; ++i)
    if (std::abs(a[i] - b[i]) > threshold) return true;
  return false;
}

/// A rectangle around all pixels that differ by more than `threshold` when they are grey. A mean of bytes that differ
/// by whole numbers up to the threshold does so too, also when it is rounded, so that most are never made grey.
cv::Rect boxOfDifferences(const EncodedPicture& picture, const Reference& reference, double threshold)
{
  const auto whole = static_cast<std::uint8_t>(threshold);  // more than 25.5 is more than 25, between whole numbers
  const cv::Mat& pixels = picture.pixels;
  const auto bytes = static_cast<int>(pixels.elemSize());
  cv::Mat gray;
  cv::Rect box;
  for (int y = 0; y < pixels.rows; ++y)
    for (int x = 0; x < pixels.cols; x += kBlock)
    {
      const cv::Rect block(x, y, std::min(kBlock, pixels.cols - x), 1);
      if ((box & block) == block) continue;
      if (!differ(pixels.ptr(y, x), reference.pixels.ptr(y, x), block.width * bytes, whole)) continue;
      if (bytes > 1)
      {
        toGray(pixels(block), picture.encoding, gray);
        if (!differ(gray.ptr(), reference.gray.ptr(y, x), block.width, whole)) continue;
      }
      box |= block;
    }
  return box;
}

/// The picture grey and blurred, within `part`; to the bit as if all of it were.
cv::Mat blurPart(const EncodedPicture& picture, const cv::Rect& part, int blur_size)
{
  const cv::Rect outer = grown(part, blur_size / 2, picture.pixels.size());
  cv::Mat gray;
  toGray(picture.pixels(outer), picture.encoding, gray);
  // A copy: cv::GaussianBlur is exact for whole pictures only. What is invented beyond its border stays out of `part`.
  if (gray.isSubmatrix()) gray = gray.clone();
  return blurred(gray, blur_size)(part - outer.tl());
}

}  // namespace

cv::Mat blurred(const cv::Mat& gray, int blur_size)
{
  cv::Mat result;
  cv::GaussianBlur(gray, result, {blur_size, blur_size}, 0.0);
  return result;
}

bool isComparable(const std::string& encoding)
{
  return encoding == "mono8" || encoding == "bgr8" || encoding == "rgb8" || encoding == "bgra8" || encoding == "rgba8";
}

cv::Rect findChangedPixels(const EncodedPicture& picture, const Reference& reference, int blur_size, double threshold,
                           cv::Mat& mask)
{
  const cv::Size size = picture.pixels.size();
  // What is true of the rounding above is of a Gaussian's, too.
  const cv::Rect part = grown(boxOfDifferences(picture, reference, threshold), blur_size / 2, size);
  if (part.empty()) return part;
  const cv::Mat background =
      reference.blurred.empty() ? blurPart({reference.gray, "mono8"}, part, blur_size) : reference.blurred(part);
  cv::Mat difference;
  cv::absdiff(blurPart(picture, part, blur_size), background, difference);
  cv::threshold(difference, mask(part), threshold, 255.0, cv::THRESH_BINARY);
  return part;
}

}  // namespace robot_vision
