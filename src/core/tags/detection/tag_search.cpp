#include "tag_search.hpp"

#include <algorithm>
#include <utility>

namespace robot_vision
{
namespace
{

constexpr double kPixelCenter = 0.5;  // px: the library counts from the first pixel's corner, OpenCV from its center

}  // namespace

TagSearch::TagSearch(std::shared_ptr<const TagDictionary> dictionary, const TagDetectorParams& params)
  : params_(params), dictionary_(std::move(dictionary)), detector_(dictionary_->makeDetector())
{
  detector_->quad_sigma = static_cast<float>(params_.blur);
  detector_->refine_edges = params_.refine_edges;
}

/// The pixels, or a copy of them where the library could not work on them as they are.
cv::Mat TagSearch::prepare(const cv::Mat& pixels, double decimate)
{
  const int least = cvCeil(kMinSearched * decimate);
  const int right = std::max(least - pixels.cols, 0);
  const int below = std::max(least - pixels.rows, 0);
  if (right > 0 || below > 0)
    cv::copyMakeBorder(pixels, copy_, 0, below, 0, right, cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
  else if (decimate > 1.0 || (params_.blur == 0.0 && pixels.step <= 2 * static_cast<std::size_t>(pixels.cols)))
    return pixels;
  else
    pixels.copyTo(copy_);  // it blurs in place, and takes memory for what lies between the rows, too
  return copy_;
}

Tag TagSearch::toTag(const apriltag_detection_t& found, const cv::Mat& gray, const cv::Rect& part) const
{
  const auto toImage = [&part](const double* p)
  { return cv::Point2d(p[0] - kPixelCenter, p[1] - kPixelCenter) + cv::Point2d(part.tl()); };
  Tag tag;
  tag.family = found.family->name;
  tag.id = found.id;
  tag.hamming = found.hamming;
  tag.margin = static_cast<double>(found.decision_margin);
  tag.center = toImage(found.c);
  std::transform(std::begin(found.p), std::end(found.p), tag.corners.begin(), toImage);
  const cv::Matx33d shift(1.0, 0.0, -kPixelCenter, 0.0, 1.0, -kPixelCenter, 0.0, 0.0, 1.0);
  const TagPattern& pattern = dictionary_->patternOf(found.family);
  tag.similarity = pattern.compare(gray(part), shift * cv::Matx33d(found.H->data), found.family->codes[tag.id]);
  return tag;
}

std::vector<Tag> TagSearch::find(const cv::Mat& gray, const cv::Rect& part, double decimate)
{
  const cv::Mat pixels = prepare(gray(part), decimate);
  detector_->quad_decimate = static_cast<float>(decimate);
  image_u8_t image = {pixels.cols, pixels.rows, static_cast<int>(pixels.step), pixels.data};
  const std::unique_ptr<zarray_t, void (*)(zarray_t*)> found(apriltag_detector_detect(detector_.get(), &image),
                                                             apriltag_detections_destroy);
  std::vector<Tag> tags;
  for (int i = 0; i < zarray_size(found.get()); ++i)
  {
    apriltag_detection_t* detection = nullptr;
    zarray_get(found.get(), i, &detection);
    if (static_cast<double>(detection->decision_margin) < params_.min_margin) continue;
    const Tag tag = toTag(*detection, gray, part);
    if (tag.similarity >= params_.min_similarity) tags.push_back(tag);
  }
  return tags;
}

}  // namespace robot_vision
