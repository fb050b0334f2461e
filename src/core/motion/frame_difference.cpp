#include "frame_difference.hpp"

#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "core/image/rects.hpp"
#include "core/image/row_bands.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

/// Blurs a part of a gray image, to the bit as it would be in the blurred image.
cv::Mat blurPart(const cv::Mat& gray, const cv::Rect& part, int blur_size)
{
  const cv::Rect outer = grown(part, blur_size / 2, gray.size());
  // A copy, as OpenCV would read pixels around `outer`. Those that it makes up instead do not reach `part`.
  return blurred(gray(outer).clone(), blur_size)(part - outer.tl());
}

}  // namespace

cv::Mat blurred(const cv::Mat& gray, int blur_size)
{
  cv::Mat result;
  cv::GaussianBlur(gray, result, {blur_size, blur_size}, 0.0);
  return result;
}

cv::Rect FrameDifference::find(const EncodedImage& image, const Reference& reference, const MotionParams& params,
                               cv::Mat& mask)
{
  if (!weights_ || weights_->size() != params.blur_size)
  {
    weights_.emplace(params.blur_size);
    are_exact_ = weights_->areExact();
  }
  if (!are_exact_) return findByOpenCv(image, reference, params, mask);
  // Differences are whole numbers: those above 25.5 are those above 25.
  const auto threshold = static_cast<std::uint8_t>(params.threshold);
  const MotionComparison comparison{image, reference, &*weights_, threshold, params.dilate};
  const int threads = cv::getNumThreads();
  const int min_rows = 2 * (params.blur_size + 2 * params.dilate);  // twice the rows that two neighbours both compute
  const auto count = static_cast<std::size_t>(bandsOf(mask.rows, threads, min_rows));
  if (stripes_.size() < count) stripes_.resize(count);
  std::vector<cv::Rect> parts(count);
  const auto run = [&](int i, const cv::Range& rows)
  { parts[static_cast<std::size_t>(i)] = stripes_[static_cast<std::size_t>(i)].run(comparison, rows, mask); };
  parallelForRows(mask.rows, threads, min_rows, run);
  cv::Rect part;
  for (const cv::Rect& of_stripe : parts)
    part |= of_stripe;
  return part;
}

cv::Rect FrameDifference::findByOpenCv(const EncodedImage& image, const Reference& reference,
                                       const MotionParams& params, cv::Mat& mask)
{
  cv::Mat gray, difference;
  toGray(image.pixels, image.encoding, gray);
  cv::absdiff(gray, reference.gray, difference);
  cv::threshold(difference, mask, params.threshold, 255.0, cv::THRESH_BINARY);
  const cv::Rect part = grown(cv::boundingRect(mask), params.blur_size / 2, mask.size());
  mask.setTo(0);
  if (part.empty()) return part;
  const cv::Mat background =
      reference.blurred.empty() ? blurPart(reference.gray, part, params.blur_size) : reference.blurred(part);
  cv::absdiff(blurPart(gray, part, params.blur_size), background, difference);
  cv::threshold(difference, mask(part), params.threshold, 255.0, cv::THRESH_BINARY);
  const cv::Rect grown_part = grown(part, params.dilate, mask.size());
  if (params.dilate > 0) cv::dilate(mask(grown_part), mask(grown_part), cv::Mat(), {-1, -1}, params.dilate);
  return grown_part;
}

}  // namespace robot_vision
