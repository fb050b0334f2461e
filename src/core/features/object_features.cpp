#include "object_features.hpp"

#include <algorithm>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/image/rects.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxObjectFeatures = 300;
constexpr int kMinRegionSide = 120;    // px; smaller regions are enlarged, or ORB's patches would reach beyond them
constexpr double kSearchReach = 2.0;   // how far around a small region nearFeatures() looks, in its longer side
constexpr double kMaxUpscaling = 4.0;  // times
constexpr int kMaxNearFeatures = 1500;
constexpr int kMinImageSide = 16;           // px; cv::ORB fails on smaller images
constexpr float kMaxDistanceRatio = 0.85F;  // of the distances to the best and to the second best match (Lowe, 2004)
constexpr int kMinMatches = 5;
constexpr double kMaxMatchError = 4.0;  // px

/// Finds features in a region that is enlarged first.
Features find(const cv::Mat& gray, const cv::Rect& region, int count, double enlarged)
{
  cv::Mat pixels = gray(region);
  if (enlarged > 1.0) cv::resize(pixels, pixels, {}, enlarged, enlarged, cv::INTER_LINEAR);
  const auto orb = cv::ORB::create(count, 1.25F, 7, 8, 0, 2, cv::ORB::HARRIS_SCORE, 31, 12);
  std::vector<cv::KeyPoint> keys;
  Features features;
  orb->detectAndCompute(pixels, cv::noArray(), keys, features.descriptors);
  const double scale = 1.0 / enlarged;
  const double half = 0.5 * (scale - 1.0);  // because integer coordinates are those of pixel centres
  const cv::Point2f origin = cv::Point2d(region.x + half, region.y + half);
  for (const cv::KeyPoint& key : keys)
    features.points.push_back(key.pt * scale + origin);
  return features;
}

}  // namespace

Features objectFeatures(const cv::Mat& gray, const cv::Rect& region)
{
  const double enlarged = std::min(region.width, region.height) < kMinRegionSide ? 2.0 : 1.0;
  return find(gray, region, kMaxObjectFeatures, enlarged);
}

Features imageFeatures(const cv::Mat& gray, int count)
{
  if (std::min(gray.rows, gray.cols) < kMinImageSide) return {};
  return find(gray, fullRect(gray), count, 1.0);
}

Features nearFeatures(const cv::Mat& gray, const cv::Rect& region)
{
  const int side = std::max({region.width, region.height, 1});
  if (side >= kMinRegionSide) return {};
  const auto reach = static_cast<int>(kSearchReach * side);
  const cv::Rect around =
      cv::Rect(region.tl() - cv::Point(reach, reach), region.br() + cv::Point(reach, reach)) & fullRect(gray);
  if (std::min(around.width, around.height) < kMinImageSide) return {};
  return find(gray, around, kMaxNearFeatures, std::min(static_cast<double>(kMinRegionSide) / side, kMaxUpscaling));
}

std::optional<Similarity> matchFeatures(const Features& object, const Features& image)
{
  if (object.points.empty() || image.points.size() < 2) return std::nullopt;
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_HAMMING).knnMatch(object.descriptors, image.descriptors, matches, 2);
  std::vector<cv::Point2f> from, to;
  for (const auto& pair : matches)
  {
    if (pair[0].distance > kMaxDistanceRatio * pair[1].distance) continue;
    from.push_back(object.points[static_cast<std::size_t>(pair[0].queryIdx)]);
    to.push_back(image.points[static_cast<std::size_t>(pair[0].trainIdx)]);
  }
  return fitSimilarity(from, to, kMaxMatchError, kMinMatches);
}

}  // namespace robot_vision
