#include "texture_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <opencv2/calib3d.hpp>
#include <utility>

namespace robot_vision
{
namespace
{

constexpr double kMinFacing = 0.25;  // cosine of the angle between where a point is seen from and was learned from
constexpr double kMaxDistanceRatio = 1.7;  // of two points of an object, by the sizes of their keypoints
constexpr double kMaxStretch = 1.3;        // of their distance in the image, by how far they seem to be
constexpr double kLengthTolerance = 0.1;   // of the distance of two points by their depths
constexpr double kDepthTolerance = 0.03;   // of the diameter; likewise
constexpr double kSearchTolerance = 0.15;  // of the diameter, of a depth in a pose by three keypoints only
constexpr double kMinApart = 0.05;         // of the diameter, between two of three points that make a pose
constexpr double kMissProbability = 1e-4;  // of a better pose than the one found, when the search ends early

/// Which candidates may be on the same object in one pose: a row of bytes for each.
class Compatibility
{
public:
  Compatibility(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& candidates, double diameter)
    : neighbors_(candidates.size()), size_(candidates.size()), together_(size_ * size_), diameter_(diameter)
  {
    for (std::size_t i = 0; i < size_; ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (areCompatible(matches[candidates[i]], matches[candidates[j]]))
        {
          together_[i * size_ + j] = together_[j * size_ + i] = 1;
          neighbors_[i].push_back(j);
          neighbors_[j].push_back(i);
        }
  }

  const std::vector<std::size_t>& of(std::size_t i) const { return neighbors_[i]; }
  bool areTogether(std::size_t i, std::size_t j) const { return together_[i * size_ + j] != 0; }

private:
  bool areCompatible(const TextureMatch& a, const TextureMatch& b) const
  {
    const double length = cv::norm(a.point - b.point);
    if (length < kMinApart * diameter_ || a.direction.dot(b.direction) < -0.5) return false;
    if (a.distance > kMaxDistanceRatio * b.distance || b.distance > kMaxDistanceRatio * a.distance) return false;
    const double seen = cv::norm(a.ray - b.ray);
    if (seen * std::min(a.distance, b.distance) > kMaxStretch * length) return false;
    if (!a.hasDepth() || !b.hasDepth()) return true;
    const cv::Vec3d apart(a.ray.x * a.depth - b.ray.x * b.depth, a.ray.y * a.depth - b.ray.y * b.depth,
                          a.depth - b.depth);
    const double noise = a.depth_deviation + b.depth_deviation;
    return std::abs(cv::norm(apart) - length) <= kLengthTolerance * length + kDepthTolerance * diameter_ + 2.0 * noise;
  }

  std::vector<std::vector<std::size_t>> neighbors_;
  std::size_t size_;
  std::vector<char> together_;
  double diameter_;
};

/// The poses, up to four, in which three points are seen where they are.
std::vector<cv::Affine3d> posesBy(const std::array<const TextureMatch*, 3>& three)
{
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> rays;
  for (const TextureMatch* match : three)
  {
    points.emplace_back(match->point);
    rays.push_back(match->ray);
  }
  std::vector<cv::Mat> turns, shifts;
  cv::solveP3P(points, rays, cv::Matx33d::eye(), cv::noArray(), turns, shifts, cv::SOLVEPNP_P3P);
  std::vector<cv::Affine3d> poses;
  for (std::size_t i = 0; i < turns.size(); ++i)
    if (cv::checkRange(turns[i]) && cv::checkRange(shifts[i]))
      poses.emplace_back(cv::Vec3d(turns[i].reshape(1, 3)), cv::Vec3d(shifts[i].reshape(1, 3)));
  return poses;
}

/// How many rounds find a pose that a share of all matches agrees with.
int roundsFor(double share)
{
  const double hit = share * share * share;
  if (hit >= 1.0) return 1;
  return static_cast<int>(std::min(std::ceil(std::log(kMissProbability) / std::log1p(-hit)), 1e6));
}

/// Three candidates that are compatible with each other, the first of which is given.
std::optional<std::array<std::size_t, 3>> drawThree(std::size_t first, const Compatibility& compatibility,
                                                    cv::RNG& random)
{
  const std::vector<std::size_t>& near = compatibility.of(first);
  const auto draw = [&] { return near[static_cast<std::size_t>(random.uniform(0, static_cast<int>(near.size())))]; };
  const std::size_t second = draw();
  for (int trial = 0; trial < 5; ++trial)
    if (const std::size_t third = draw(); compatibility.areTogether(second, third)) return {{first, second, third}};
  return std::nullopt;
}

}  // namespace

bool agrees(const TextureMatch& match, const cv::Affine3d& pose, double depth_tolerance)
{
  const cv::Vec3d point = pose * match.point;
  if (!(point[2] > 0.0)) return false;
  const double x = point[0] / point[2] - match.ray.x, y = point[1] / point[2] - match.ray.y;
  if (!(x * x + y * y <= match.tolerance * match.tolerance)) return false;
  const cv::Vec3d to_point = pose.rotation() * match.direction;
  if (-to_point.dot(point) < kMinFacing * cv::norm(point)) return false;
  return !match.hasDepth() || std::abs(match.depth - point[2]) <= depth_tolerance + 3.0 * match.depth_deviation;
}

std::vector<std::size_t> inliersOf(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& candidates,
                                   const cv::Affine3d& pose, double depth_tolerance)
{
  std::vector<std::size_t> inliers;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(inliers),
               [&](std::size_t i) { return agrees(matches[i], pose, depth_tolerance); });
  return inliers;
}

std::optional<TexturePose> searchTexture(const std::vector<TextureMatch>& matches,
                                         const std::vector<std::size_t>& candidates, const TextureSearchParams& params,
                                         cv::RNG& random)
{
  const Compatibility compatibility(matches, candidates, params.diameter);
  std::vector<std::size_t> firsts;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (compatibility.of(i).size() + 1 >= static_cast<std::size_t>(params.min_inliers)) firsts.push_back(i);
  if (firsts.size() < static_cast<std::size_t>(params.min_inliers)) return std::nullopt;
  TexturePose best;
  int rounds = params.rounds;
  for (int round = 0; round < rounds; ++round)
  {
    const std::size_t first = firsts[static_cast<std::size_t>(random.uniform(0, static_cast<int>(firsts.size())))];
    const auto three = drawThree(first, compatibility, random);
    if (!three) continue;
    const auto matchOf = [&](std::size_t i) { return &matches[candidates[(*three)[i]]]; };
    for (const cv::Affine3d& pose : posesBy({matchOf(0), matchOf(1), matchOf(2)}))
    {
      std::vector<std::size_t> inliers = inliersOf(matches, candidates, pose, kSearchTolerance * params.diameter);
      if (inliers.size() <= best.inliers.size()) continue;
      best = {pose, std::move(inliers)};
      const double share = static_cast<double>(best.inliers.size()) / static_cast<double>(firsts.size());
      rounds = std::min(params.rounds, roundsFor(share));
    }
  }
  if (best.inliers.size() < static_cast<std::size_t>(params.min_inliers)) return std::nullopt;
  return best;
}

}  // namespace robot_vision
