#include "frame_difference.hpp"

#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "core/image/gaussian_filter_rows.hpp"
#include "core/image/rects.hpp"
#include "core/image/row_bands.hpp"
#include "motion_stripe.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

/// A part of a gray picture, blurred; to the bit as if all of it were.
cv::Mat blurPart(const cv::Mat& gray, const cv::Rect& part, int blur_size)
{
  const cv::Rect outer = grown(part, blur_size / 2, gray.size());
  // A copy: OpenCV would look beyond it. What is invented beyond its border stays out of `part`.
  return blurred(gray(outer).clone(), blur_size)(part - outer.tl());
}

}  // namespace

cv::Mat blurred(const cv::Mat& gray, int blur_size)
{
  cv::Mat result;
  cv::GaussianBlur(gray, result, {blur_size, blur_size}, 0.0);
  return result;
}

struct FrameDifference::Impl
{
  std::optional<GaussWeights> weights;
  bool are_exact = false;  // the weights
  std::vector<MotionStripe> bands;
};

FrameDifference::FrameDifference() : impl_(std::make_unique<Impl>())
{
}
FrameDifference::~FrameDifference() = default;
FrameDifference::FrameDifference(FrameDifference&&) noexcept = default;
FrameDifference& FrameDifference::operator=(FrameDifference&&) noexcept = default;

cv::Rect FrameDifference::find(const EncodedPicture& picture, const Reference& reference, const Comparison& how,
                               cv::Mat& mask)
{
  Impl& me = *impl_;
  if (!me.weights || me.weights->size() != how.blur_size)
  {
    me.weights.emplace(how.blur_size);
    me.are_exact = me.weights->areExact();
  }
  if (!me.are_exact) return findByOpenCv(picture, reference, how, mask);
  // More than 25.5 is more than 25, between whole numbers.
  const auto threshold = static_cast<std::uint8_t>(how.threshold);
  const MotionComparison comparison{picture, reference, &*me.weights, threshold, how.dilate};
  const int threads = cv::getNumThreads();
  const int least_rows = 2 * (how.blur_size + 2 * how.dilate);  // twice those that a band makes for its neighbours, too
  const auto bands = static_cast<std::size_t>(bandsOf(mask.rows, threads, least_rows));
  if (me.bands.size() < bands) me.bands.resize(bands);
  std::vector<cv::Rect> parts(bands);
  const auto run = [&](int i, const cv::Range& rows)
  { parts[static_cast<std::size_t>(i)] = me.bands[static_cast<std::size_t>(i)].run(comparison, rows, mask); };
  parallelForRows(mask.rows, threads, least_rows, run);
  cv::Rect part;
  for (const cv::Rect& of_band : parts)
    part |= of_band;
  return part;
}

cv::Rect FrameDifference::findByOpenCv(const EncodedPicture& picture, const Reference& reference, const Comparison& how,
                                       cv::Mat& mask)
{
  cv::Mat gray, difference;
  toGray(picture.pixels, picture.encoding, gray);
  cv::absdiff(gray, reference.gray, difference);
  cv::threshold(difference, mask, how.threshold, 255.0, cv::THRESH_BINARY);
  const cv::Rect part = grown(cv::boundingRect(mask), how.blur_size / 2, mask.size());
  mask.setTo(0);
  if (part.empty()) return part;
  const cv::Mat background =
      reference.blurred.empty() ? blurPart(reference.gray, part, how.blur_size) : reference.blurred(part);
  cv::absdiff(blurPart(gray, part, how.blur_size), background, difference);
  cv::threshold(difference, mask(part), how.threshold, 255.0, cv::THRESH_BINARY);
  const cv::Rect grown_part = grown(part, how.dilate, mask.size());
  if (how.dilate > 0) cv::dilate(mask(grown_part), mask(grown_part), cv::Mat(), {-1, -1}, how.dilate);
  return grown_part;
}

}  // namespace robot_vision
