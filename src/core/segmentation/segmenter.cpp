#include "robot_vision/segmentation/segmenter.hpp"

#include <mutex>
#include <opencv2/imgproc.hpp>

#include "color_clusters.hpp"
#include "core/image/rects.hpp"
#include "label_numbers.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "seed_map.hpp"
#include "segment_methods.hpp"

namespace robot_vision
{
namespace
{

constexpr double kFar = 1 << 24;  // px; sums and differences of such numbers still fit an int

void requireNear(const std::string& name, const cv::Point& point)
{
  requireRange(name + "'s x", point.x, -kFar, kFar);
  requireRange(name + "'s y", point.y, -kFar, kFar);
}

/// The image in the size that is worked on; the image itself if that is its own.
cv::Mat reduced(const cv::Mat& bgr, double scale)
{
  const cv::Size size = scaledSize(bgr.size(), scale);
  if (size == bgr.size()) return bgr;
  cv::Mat smaller;
  cv::resize(bgr, smaller, size, 0.0, 0.0, cv::INTER_AREA);
  return smaller;
}

}  // namespace

struct Segmenter::Impl
{
  Division divide(const cv::Mat& bgr, const SeedMap& seed_map, double scale)
  {
    if (params.method == "watershed") return watershed(bgr, seed_map, params, scale);
    if (params.method == "grab_cut") return grabCut(bgr, seed_map, params);
    if (params.method == "flood_fill") return floodFill(bgr, seed_map, params);
    if (params.method == "mean_shift") return meanShift(bgr, params, scale);
    if (params.method == "distance_transform") return distanceTransform(bgr, params, scale);
    return {clusters.apply(bgr, params), false, ""};
  }

  void add(const SegmentSeed& seed)
  {
    const std::lock_guard<std::mutex> lock(mutex);
    const auto most = static_cast<double>(kMaxSeeds);
    requireRange("the number of seeds", static_cast<double>(seeds.size()) + 1.0, 1.0, most);
    seeds.push_back(seed);
  }

  SegmenterParams params;
  std::vector<SegmentSeed> seeds;
  ColorClusters clusters;
  LabelNumbers numbers;
  std::mutex mutex;  // guards all above; held during a call
};

Segmenter::Segmenter(const SegmenterParams& params) : impl_(std::make_unique<Impl>())
{
  configure(params);
}

Segmenter::~Segmenter() = default;

void Segmenter::configure(const SegmenterParams& params)
{
  validate(params);
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  if (params.method != impl_->params.method)
  {
    impl_->clusters.forget();
    impl_->numbers = LabelNumbers();
  }
  impl_->params = params;
}

void Segmenter::addRegion(const cv::Rect& region)
{
  const bool fits = region.width > 0 && region.height > 0 && region.width <= kFar && region.height <= kFar;
  require(fits, "the region's size", toText(region.size()), "from 1x1 to 16777216x16777216");
  requireNear("the region", region.tl());
  impl_->add({region, (region.tl() + region.br()) / 2});
}

void Segmenter::addPoint(const cv::Point& point)
{
  requireNear("the pixel", point);
  impl_->add({cv::Rect(), point});
}

void Segmenter::clearSeeds()
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->seeds.clear();
}

std::vector<SegmentSeed> Segmenter::seeds() const
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->seeds;
}

Segmentation Segmenter::apply(const cv::Mat& image, const std::string& encoding)
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  const SegmenterParams& params = impl_->params;
  cv::Mat bgr;
  toBgr(image, encoding, bgr);
  const cv::Mat small = reduced(bgr, params.scale);
  const double scale = static_cast<double>(small.cols) / bgr.cols;
  const SeedMap seed_map(impl_->seeds, bgr.size(), small.size(), params);
  const Division division = impl_->divide(small, seed_map, scale);
  Segmentation result;
  result.hint = division.hint;
  if (params.method == "k_means") result.centers = impl_->clusters.centers().clone();
  const double area_scale = static_cast<double>(small.total()) / static_cast<double>(bgr.total());
  const NumberingRule rule{params.min_area * area_scale, params.max_segments, division.by_size, params.keep_labels};
  const cv::Mat numbers = impl_->numbers.apply(division.labels, rule);
  if (numbers.size() == bgr.size())
    result.labels = numbers.clone();
  else
    cv::resize(numbers, result.labels, bgr.size(), 0.0, 0.0, cv::INTER_NEAREST);
  return result;
}

}  // namespace robot_vision
