#include "object_features.hpp"

#include <algorithm>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace robot_vision
{
namespace
{

constexpr int kObjectFeatures = 300;
constexpr int kSmallRegion = 120;     // px: a shorter side is enlarged, or features would look beyond its edges
constexpr double kReach = 2.0;        // sides of a small region to its every side, in which it is looked for
constexpr double kMaxEnlarged = 4.0;  // times
constexpr int kNearFeatures = 1500;
constexpr int kSmallestPicture = 16;  // px: cv::ORB would fail on what is left of a smaller one
constexpr float kRatio = 0.85F;       // of the distances to the best and the second best match (Lowe, 2004)
constexpr int kFewestMatches = 5;
constexpr double kTolerance = 4.0;  // px

Features find(const cv::Mat& gray, int count, double scale, const cv::Point2f& origin)
{
  const auto orb = cv::ORB::create(count, 1.25F, 7, 8, 0, 2, cv::ORB::HARRIS_SCORE, 31, 12);
  std::vector<cv::KeyPoint> keys;
  Features features;
  orb->detectAndCompute(gray, cv::noArray(), keys, features.descriptors);
  for (const cv::KeyPoint& key : keys)
    features.points.push_back(key.pt * scale + origin);
  return features;
}

/// Of a part of the picture that is enlarged first.
Features findEnlarged(const cv::Mat& gray, const cv::Rect& region, int count, double enlarged)
{
  cv::Mat pixels = gray(region);
  if (enlarged > 1.0) cv::resize(pixels, pixels, {}, enlarged, enlarged, cv::INTER_LINEAR);
  const double half = 0.5 * (1.0 / enlarged - 1.0);  // pixels' middles, not their corners, are whole
  return find(pixels, count, 1.0 / enlarged, cv::Point2d(region.x + half, region.y + half));
}

}  // namespace

Features objectFeatures(const cv::Mat& gray, const cv::Rect& region)
{
  const double enlarged = std::min(region.width, region.height) < kSmallRegion ? 2.0 : 1.0;
  return findEnlarged(gray, region, kObjectFeatures, enlarged);
}

Features pictureFeatures(const cv::Mat& gray, int count)
{
  if (std::min(gray.rows, gray.cols) < kSmallestPicture) return {};
  return find(gray, count, 1.0, {});
}

Features nearFeatures(const cv::Mat& gray, const cv::Rect& region)
{
  const int side = std::max({region.width, region.height, 1});
  if (side >= kSmallRegion) return {};
  const auto reach = static_cast<int>(kReach * side);
  const cv::Rect around = cv::Rect(region.tl() - cv::Point(reach, reach), region.br() + cv::Point(reach, reach)) &
                          cv::Rect({}, gray.size());
  if (std::min(around.width, around.height) < kSmallestPicture) return {};
  return findEnlarged(gray, around, kNearFeatures, std::min(static_cast<double>(kSmallRegion) / side, kMaxEnlarged));
}

std::optional<Similarity> matchFeatures(const Features& object, const Features& picture)
{
  if (object.points.empty() || picture.points.size() < 2) return std::nullopt;
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_HAMMING).knnMatch(object.descriptors, picture.descriptors, matches, 2);
  std::vector<cv::Point2f> from, to;
  for (const auto& pair : matches)
  {
    if (pair[0].distance > kRatio * pair[1].distance) continue;
    from.push_back(object.points[static_cast<std::size_t>(pair[0].queryIdx)]);
    to.push_back(picture.points[static_cast<std::size_t>(pair[0].trainIdx)]);
  }
  return fitSimilarity(from, to, kTolerance, kFewestMatches);
}

}  // namespace robot_vision
