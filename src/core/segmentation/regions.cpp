#include "robot_vision/segmentation/regions.hpp"

#include <algorithm>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/image/rects.hpp"
#include "robot_vision/image/encoding.hpp"
#include "runs.hpp"

namespace robot_vision
{
namespace
{

constexpr double kHalfPixel = 0.5;  // px

cv::Mat ellipse(int diameter)
{
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {diameter, diameter});
}

/// Sums over the pixels of a region.
struct Sums
{
  std::int64_t count = 0;
  std::int64_t x = 0;
  std::int64_t y = 0;
};

cv::Rect boxOf(const std::vector<Run>& runs)
{
  int left = runs.front().begin, right = runs.front().end;
  for (const Run& run : runs)
  {
    left = std::min(left, run.begin);
    right = std::max(right, run.end);
  }
  return {left, runs.front().y, right - left, runs.back().y + 1 - runs.front().y};
}

/// The sums of each region, at the index of its first run.
std::vector<Sums> sumUp(const std::vector<Run>& runs)
{
  std::vector<Sums> all(runs.size());
  for (const Run& run : runs)
  {
    Sums& sums = all[run.first];
    const std::int64_t count = run.end - run.begin;
    sums.count += count;
    sums.x += count * (run.begin + run.end - 1) / 2;
    sums.y += count * run.y;
  }
  return all;
}

/// Adds the smallest circle around the outline.
void addCircle(Region& region)
{
  std::vector<cv::Point> hull;  // has the same circle, which is found much faster
  cv::convexHull(region.outline, hull);
  cv::Point2f center;
  float radius = 0.0F;
  cv::minEnclosingCircle(hull, center, radius);
  region.circle_center = center;
  region.circle_radius = hull.size() > 1 ? radius : 0.0;  // OpenCV's radius is never 0
  const double edge = region.circle_radius + kHalfPixel;
  region.roundness = std::min(1.0, region.area / (CV_PI * edge * edge));
}

}  // namespace

RegionFinder::RegionFinder(const RegionParams& params) : params_(params)
{
  validate(params);
  opening_ = ellipse(params.opening);
  closing_ = ellipse(params.closing);
}

std::vector<Region> RegionFinder::apply(cv::Mat& mask) const
{
  return apply(mask, fullRect(mask));
}

std::vector<Region> RegionFinder::apply(cv::Mat& mask, const cv::Rect& part) const
{
  checkPixels(mask, "mono8");
  const std::vector<Run> runs = findRuns(mask, clean(mask, part & fullRect(mask)));
  if (runs.empty()) return {};
  const cv::Rect white = boxOf(runs);
  const std::vector<Sums> all_sums = sumUp(runs);
  std::vector<std::vector<cv::Point>> borders;
  std::vector<cv::Vec4i> hierarchy;  // of each border: the next one, the previous, the first hole, the parent
  cv::findContours(mask(white), borders, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE, white.tl());

  std::vector<std::pair<const Sums*, int>> found;  // with the number of the outer border
  for (int outer = 0; outer >= 0; outer = hierarchy[outer][0])
  {
    const Sums& sums = all_sums[runAt(runs, borders[outer][0]).first];
    if (static_cast<double>(sums.count) >= params_.min_area) found.emplace_back(&sums, outer);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first->count > b.first->count; });
  if (found.size() > kMaxRegions) found.resize(kMaxRegions);

  std::vector<Region> regions;
  for (const auto& [sums, outer] : found)
  {
    Region region;
    region.area = static_cast<double>(sums->count);
    region.center = {sums->x / region.area, sums->y / region.area};
    region.outline = std::move(borders[outer]);
    region.box = cv::boundingRect(region.outline);
    addCircle(region);
    regions.push_back(std::move(region));
  }
  return regions;
}

cv::Rect RegionFinder::clean(cv::Mat& mask, const cv::Rect& part) const
{
  if (part.empty() || (params_.opening <= 1 && params_.closing <= 1)) return part;
  const cv::Rect white = cv::boundingRect(mask(part));
  if (white.empty()) return white;
  const cv::Rect changed = grown(white + part.tl(), params_.closing, mask.size());  // as far as the closing reaches
  cv::Mat pixels = mask(changed);
  const auto transform = [&](int operation, const cv::Mat& element)
  {
    // BORDER_ISOLATED keeps OpenCV from reading the pixels around a mask that is a part of a larger matrix.
    cv::morphologyEx(pixels, pixels, operation, element, {-1, -1}, 1, cv::BORDER_CONSTANT | cv::BORDER_ISOLATED);
  };
  if (params_.opening > 1) transform(cv::MORPH_OPEN, opening_);
  if (params_.closing > 1) transform(cv::MORPH_CLOSE, closing_);
  return changed;
}

}  // namespace robot_vision
