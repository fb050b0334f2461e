#include "changed_pixels.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "gauss_rows.hpp"
#include "motion_band.hpp"
#include "rects.hpp"
#include "robot_vision/encoding.hpp"
#include "row_bands.hpp"

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
  const auto look = [&](int y, int begin, int end)
  {
    for (int x = begin; x < end; x += kBlock)
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
  };
  // From both ends: between them only what is beside the box is left to look at.
  int top = 0;
  int bottom = pixels.rows;
  while (box.empty() && top < bottom)
    look(top++, 0, pixels.cols);
  while (box.br().y < bottom && top < bottom)
    look(--bottom, 0, pixels.cols);
  for (int y = top; y < bottom; ++y)
  {
    look(y, 0, box.x);
    look(y, box.br().x, pixels.cols);
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

/// The part of the picture outside of which no blurred pixel differs.
cv::Rect partToCompare(const EncodedPicture& picture, const Reference& reference, const Comparison& how)
{
  // What is true of the rounding above is of a Gaussian's, too.
  return grown(boxOfDifferences(picture, reference, how.threshold), how.blur_size / 2, picture.pixels.size());
}

/// Blackens a part of a mask but for what is in another, too.
void blacken(const cv::Rect& part, const cv::Rect& but, cv::Mat& mask)
{
  const cv::Rect kept = part & but;
  if (kept.empty())
  {
    mask(part).setTo(0);
    return;
  }
  const cv::Rect above(part.tl(), cv::Point(part.br().x, kept.y));
  const cv::Rect below(cv::Point(part.x, kept.br().y), part.br());
  const cv::Rect left(cv::Point(part.x, kept.y), cv::Point(kept.x, kept.br().y));
  const cv::Rect right(cv::Point(kept.br().x, kept.y), cv::Point(part.br().x, kept.br().y));
  for (const cv::Rect& rest : {above, below, left, right})
    mask(rest).setTo(0);
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

struct ChangedPixels::Impl
{
  std::optional<GaussWeights> weights;
  bool are_exact = false;  // the weights
  std::vector<MotionBand> bands;
};

ChangedPixels::ChangedPixels() : impl_(std::make_unique<Impl>())
{
}
ChangedPixels::~ChangedPixels() = default;
ChangedPixels::ChangedPixels(ChangedPixels&&) noexcept = default;
ChangedPixels& ChangedPixels::operator=(ChangedPixels&&) noexcept = default;

cv::Rect ChangedPixels::find(const EncodedPicture& picture, const Reference& reference, const Comparison& how,
                             const cv::Rect& white, cv::Mat& mask)
{
  Impl& me = *impl_;
  if (!me.weights || me.weights->size() != how.blur_size)
  {
    me.weights.emplace(how.blur_size);
    me.are_exact = me.weights->areExact();
  }
  if (!me.are_exact) return findByOpenCv(picture, reference, how, white, mask);
  const cv::Rect near = partToCompare(picture, reference, how);
  const cv::Rect part = grown(near, std::max(me.weights->half(), how.dilate), mask.size());
  blacken(white, part, mask);
  if (part.empty()) return part;
  const auto threshold = static_cast<std::uint8_t>(how.threshold);
  const MotionComparison comparison{picture, reference, near, part, &*me.weights, threshold, how.dilate};
  const int threads = cv::getNumThreads();
  const int least_rows = 2 * (how.blur_size + 2 * how.dilate);  // twice those that a band makes for its neighbours, too
  const int bands = bandsOf(part.height, threads, least_rows);
  if (me.bands.size() < static_cast<std::size_t>(bands)) me.bands.resize(static_cast<std::size_t>(bands));
  forRowBands(part.height, threads, least_rows,
              [&](int i, const cv::Range& rows) { me.bands[static_cast<std::size_t>(i)].run(comparison, rows, mask); });
  return part;
}

cv::Rect ChangedPixels::findByOpenCv(const EncodedPicture& picture, const Reference& reference, const Comparison& how,
                                     const cv::Rect& white, cv::Mat& mask)
{
  mask(white).setTo(0);
  const cv::Rect part = partToCompare(picture, reference, how);
  if (part.empty()) return part;
  const cv::Mat background =
      reference.blurred.empty() ? blurPart({reference.gray, "mono8"}, part, how.blur_size) : reference.blurred(part);
  cv::Mat difference;
  cv::absdiff(blurPart(picture, part, how.blur_size), background, difference);
  cv::threshold(difference, mask(part), how.threshold, 255.0, cv::THRESH_BINARY);
  const cv::Rect grown_part = grown(part, how.dilate, mask.size());
  if (how.dilate > 0) cv::dilate(mask(grown_part), mask(grown_part), cv::Mat(), {-1, -1}, how.dilate);
  return grown_part;
}

}  // namespace robot_vision
