#include "segment_methods.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/common/random_state.hpp"
#include "core/common/work_limit.hpp"
#include "robot_vision/common/range.hpp"
#include "similar_neighbors.hpp"
#include "touching_objects.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinSamples = 5;  // px that cv::grabCut needs of the object and of the background: one for each Gaussian

constexpr double kMaxPixelsOfWindows = 1e9;  // of mean_shift for an image, up to 7 ns each
constexpr double kMaxRefinements = 2e7;      // of pixels by grab_cut for an image, some 400 ns each

/// A division into nothing.
Division nothing(const cv::Mat& bgr, const std::string& hint)
{
  return {cv::Mat::zeros(bgr.size(), CV_32SC1), true, hint};
}

/// Whether there are enough pixels of both kinds to begin with.
std::string lackOfSamples(const cv::Mat& mask)
{
  const int object = cv::countNonZero((mask == cv::GC_FGD) | (mask == cv::GC_PR_FGD));
  const int background = static_cast<int>(mask.total()) - object;
  if (object < kMinSamples) return "the seeds for grab_cut are too small";
  if (background < kMinSamples)
    return "the seeds for grab_cut leave no background: drag smaller rectangles, or set a border";
  return "";
}

}  // namespace

Division watershed(const cv::Mat& bgr, const SeedMap& seeds, const SegmenterParams& params, double scale)
{
  if (seeds.empty() && !params.automatic)
    return nothing(bgr, "watershed has no seeds: drag rectangles or click, or set automatic");
  Division division;
  int background = static_cast<int>(Segmenter::kMaxSeeds) + 1;
  if (seeds.empty())
  {
    const ObjectSeeds objects = findObjectSeeds(bgr, params, scale);
    background = objects.count + 1;
    division.labels = watershedMarkers(objects);
  }
  else
  {
    division.by_size = false;
    division.labels = seeds.markers(background);
  }
  cv::watershed(bgr, division.labels);
  division.labels.setTo(0, (division.labels < 0) | (division.labels == background));
  return division;
}

Division grabCut(const cv::Mat& bgr, const SeedMap& seeds, const SegmenterParams& params)
{
  if (seeds.empty()) return nothing(bgr, "grab_cut has no seeds: drag a rectangle around an object, or click");
  cv::Mat mask = seeds.grabCutMask();
  requireWork("iterations is " + toText(params.iterations) + " at scale " + toText(params.scale), params.iterations,
              bgr.size(), kMaxRefinements);
  const std::string lack = lackOfSamples(mask);
  if (!lack.empty()) return nothing(bgr, lack);
  cv::Mat background, object;  // the Gaussians
  const RandomState state(params.random_seed);
  cv::grabCut(bgr, mask, {}, background, object, params.iterations, cv::GC_INIT_WITH_MASK);
  Division division{{}, false, ""};
  cv::Mat(mask & 1).convertTo(division.labels, CV_32S);  // GC_FGD and GC_PR_FGD are odd
  return division;
}

Division floodFill(const cv::Mat& bgr, const SeedMap& seeds, const SegmenterParams& params)
{
  if (seeds.empty()) return nothing(bgr, "flood_fill has no seeds: click");
  const int newly = 2, before = 1;  // values of the mask
  const int flags = 4 | cv::FLOODFILL_MASK_ONLY | (params.fixed_range ? cv::FLOODFILL_FIXED_RANGE : 0) | (newly << 8);
  cv::Mat image = bgr;  // which is not written to, as only the mask is filled
  cv::Mat mask = cv::Mat::zeros(bgr.rows + 2, bgr.cols + 2, CV_8UC1);
  Division division{cv::Mat::zeros(bgr.size(), CV_32SC1), false, ""};
  for (const SeedMap::Spot& spot : seeds.spots())
  {
    cv::Rect box;
    cv::floodFill(image, mask, spot.point, {}, &box, cv::Scalar::all(params.lower_difference),
                  cv::Scalar::all(params.upper_difference), flags);
    if (box.empty()) continue;  // an earlier seed has come here
    cv::Mat filled = mask(box + cv::Point(1, 1));
    const cv::Mat is_new = filled == newly;
    division.labels(box).setTo(spot.number, is_new);
    filled.setTo(before, is_new);
  }
  return division;
}

Division meanShift(const cv::Mat& bgr, const SegmenterParams& params, double scale)
{
  const double radius = params.spatial_radius * scale;
  const double side = 2.0 * radius + 1.0;
  requireWork("spatial_radius is " + toText(params.spatial_radius) + " at scale " + toText(params.scale), side * side,
              bgr.size(), kMaxPixelsOfWindows);
  cv::Mat flat;
  cv::pyrMeanShiftFiltering(bgr, flat, radius, params.color_radius, params.levels);
  return {similarNeighbors(flat, params.color_tolerance), true, ""};
}

Division distanceTransform(const cv::Mat& bgr, const SegmenterParams& params, double scale)
{
  return {divideObjects(findObjectSeeds(bgr, params, scale)), true, ""};
}

}  // namespace robot_vision
