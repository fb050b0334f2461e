#include "texture_fit.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "pose_solver.hpp"
#include "texture_places.hpp"

namespace robot_vision
{
namespace
{

constexpr int kRefits = 5;
constexpr int kSteps = 20;
constexpr double kToleranceDeviations = 3.0;  // standard deviations of a keypoint that its tolerance has
constexpr double kDepthTolerance = 0.03;      // of the diameter, beyond the noise and the bias
constexpr double kMinVariance = 0.1;          // of the residuals, by what tolerances say
constexpr double kPlane = 0.15;               // thickness of what is flat, of its width
constexpr double kMinFlip = 0.05;             // rad, between two tilts of a plane that are worth a look
constexpr double kEvidence = 0.25;            // of a difference of costs: errors of neighbours are alike
constexpr double kMinDoubt = 0.02;            // probability of the other tilt that is told
constexpr double kSharedErrors = 1.5;         // times the variance that it would have if no errors were alike

/// Of each match the share that is not what others at its place in the image say, too.
std::vector<double> sharesOf(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& chosen)
{
  std::map<TexturePlace, int> counts;
  for (const std::size_t i : chosen)
    ++counts[placeInImage(matches[i])];
  std::vector<double> shares;
  for (const std::size_t i : chosen)
    shares.push_back(1.0 / counts[placeInImage(matches[i])]);
  return shares;
}

/// How far a depth is from where a pose has it.
struct DepthResidual
{
  cv::Vec3d lever;   // m, of the point from the object's origin
  double residual;   // m
  double deviation;  // m, of its noise
  double share;
};

/// Adds depths, which have an error in common: their mean tells a shift as well as that allows, and how they differ
/// from it tells how the object is turned, as well as their noise does.
void addDepths(const std::vector<DepthResidual>& depths, double bias, PoseEquations& equations)
{
  double weights = 0.0, mean = 0.0;
  cv::Vec3d lever;
  for (const DepthResidual& depth : depths)
  {
    const double weight = depth.share / (depth.deviation * depth.deviation);
    weights += weight;
    mean += weight * depth.residual;
    lever += weight * depth.lever;
  }
  if (!(weights > 0.0)) return;
  mean /= weights;
  lever *= 1.0 / weights;
  const cv::Vec3d ahead(0.0, 0.0, 1.0);
  equations.add(ahead, lever, mean, std::sqrt(1.0 / weights + bias * bias), 1.0);
  for (const DepthResidual& depth : depths)
  {
    const cv::Vec3d turn = (depth.lever - lever).cross(ahead);
    equations.addRow({0.0, 0.0, 0.0, turn[0], turn[1], turn[2]}, depth.residual - mean, depth.deviation, depth.share);
  }
}

/// The residuals of the chosen matches.
class TextureResiduals
{
public:
  TextureResiduals(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& chosen, double bias)
    : matches_(matches), chosen_(chosen), shares_(sharesOf(matches, chosen)), bias_(bias)
  {
  }

  PoseEquations operator()(const cv::Affine3d& pose) const
  {
    PoseEquations equations;
    std::vector<DepthResidual> depths;
    for (std::size_t i = 0; i < chosen_.size(); ++i)
      add(matches_[chosen_[i]], pose, shares_[i], equations, depths);
    addDepths(depths, bias_, equations);
    return equations;
  }

private:
  static void add(const TextureMatch& match, const cv::Affine3d& pose, double share, PoseEquations& equations,
                  std::vector<DepthResidual>& depths)
  {
    const cv::Vec3d lever = pose.rotation() * match.point, point = lever + pose.translation();
    if (!(point[2] > 0.0)) return equations.addMissing(2.0 * share);
    const double inverse = 1.0 / point[2], x = point[0] * inverse, y = point[1] * inverse;
    const double deviation = match.tolerance / kToleranceDeviations;
    equations.add({inverse, 0.0, -x * inverse}, lever, match.ray.x - x, deviation, share);
    equations.add({0.0, inverse, -y * inverse}, lever, match.ray.y - y, deviation, share);
    if (match.hasDepth()) depths.push_back({lever, match.depth - point[2], match.depth_deviation, share});
  }

  const std::vector<TextureMatch>& matches_;
  const std::vector<std::size_t>& chosen_;
  std::vector<double> shares_;
  double bias_;  // m, standard deviation of what all depths have in common
};

/// The inverse of an information matrix, whose shifts and rotations differ too much in size to be inverted as they are.
cv::Matx66d covarianceOf(const PoseEquations& equations, const MotionLimits& limits)
{
  cv::Matx66d information = equations.information(), scale = cv::Matx66d::zeros();
  for (int i = 0; i < 6; ++i)
  {
    const double deviation = i < 3 ? limits.shift : limits.turn;
    information(i, i) += 1.0 / (deviation * deviation);
    scale(i, i) = 1.0 / std::sqrt(information(i, i));
  }
  const cv::Matx66d inverse = (scale * information * scale).inv(cv::DECOMP_CHOLESKY);
  return kSharedErrors * std::max(equations.variance(), kMinVariance) * (scale * inverse * scale);
}

/// The share of the matches whose depth is known that agree with it.
double depthAgreement(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& candidates,
                      const cv::Affine3d& pose, double tolerance)
{
  int known = 0, agreeing = 0;
  for (const std::size_t i : candidates)
  {
    if (!matches[i].hasDepth() || !agrees(matches[i], pose, std::numeric_limits<double>::infinity())) continue;
    ++known;
    agreeing += agrees(matches[i], pose, tolerance) ? 1 : 0;
  }
  return known > 0 ? static_cast<double>(agreeing) / known : NAN;
}

/// What is fitted, and to what.
struct Fitting
{
  const std::vector<TextureMatch>& matches;
  const std::vector<std::size_t>& candidates;
  MotionLimits limits;
  double depth_bias;  // m
  double tolerance;   // m, of depths

  /// A pose by all that agree with it.
  TexturePose fitted(const TexturePose& first) const
  {
    TexturePose found = first;
    for (int round = 0; round < kRefits; ++round)
    {
      const TextureResiduals residuals(matches, found.inliers, depth_bias);
      found.pose = solveMotion(found.pose, limits, residuals);
      std::vector<std::size_t> inliers = inliersOf(matches, candidates, found.pose, tolerance);
      const bool is_settled = inliers == found.inliers;
      found.inliers = std::move(inliers);
      if (is_settled) break;
    }
    return found;
  }

  /// The pose with the plane that the inliers are on tilted to the other side; none if they are on no plane.
  std::optional<cv::Affine3d> flipped(const TexturePose& found) const
  {
    const PlaceSpread spread = spreadOf(matches, found.inliers);
    if (spread.deviations[2] > kPlane * spread.deviations[1]) return std::nullopt;
    const cv::Vec3d middle = found.pose * spread.mean, sight = cv::normalize(middle);
    const cv::Vec3d normal = found.pose.rotation() * spread.normal;
    const cv::Vec3d other = 2.0 * sight.dot(normal) * sight - normal, axis = normal.cross(other);
    const double sine = cv::norm(axis), angle = std::atan2(sine, normal.dot(other));
    if (sine < 1e-6 || std::min(angle, CV_PI - angle) < kMinFlip) return std::nullopt;
    const cv::Affine3d turn(axis * (angle / sine));
    return cv::Affine3d(turn.rotation() * found.pose.rotation(),
                        middle + turn.rotation() * (found.pose.translation() - middle));
  }

  /// How much more one pose costs than the other, of all that agrees with one of both.
  double costDifference(const TexturePose& one, const TexturePose& other) const
  {
    std::vector<std::size_t> both;
    std::set_union(one.inliers.begin(), one.inliers.end(), other.inliers.begin(), other.inliers.end(),
                   std::back_inserter(both));
    const TextureResiduals residuals(matches, both, depth_bias);
    return residuals(one.pose).cost() - residuals(other.pose).cost();
  }

  TextureFit fitOf(const TexturePose& found, double probability) const
  {
    const TextureResiduals residuals(matches, found.inliers, depth_bias);
    return {found, covarianceOf(residuals(found.pose), limits),
            depthAgreement(matches, candidates, found.pose, tolerance), probability};
  }
};

}  // namespace

std::vector<TextureFit> fitTexture(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& candidates,
                                   const TexturePose& first, const MeshExtent& extent, double depth_bias)
{
  const double tolerance = kDepthTolerance * extent.diameter + 3.0 * depth_bias;
  const Fitting fitting{matches, candidates, {extent.diameter, 1.0, extent.radius, kSteps}, depth_bias, tolerance};
  const TexturePose one = fitting.fitted(first);
  const auto flipped = fitting.flipped(one);
  if (!flipped) return {fitting.fitOf(one, 1.0)};
  const TexturePose other = fitting.fitted({*flipped, one.inliers});
  const cv::Vec6d apart = difference(one.pose, other.pose);
  if (cv::norm(cv::Vec3d(apart[3], apart[4], apart[5])) < kMinFlip) return {fitting.fitOf(one, 1.0)};
  const double doubt = std::exp(-kEvidence * std::abs(fitting.costDifference(one, other)));
  const double probability = 1.0 / (1.0 + doubt);
  const bool is_better = fitting.costDifference(one, other) <= 0.0;
  const TextureFit best = fitting.fitOf(is_better ? one : other, probability);
  if (1.0 - probability < kMinDoubt) return {best};
  return {best, fitting.fitOf(is_better ? other : one, 1.0 - probability)};
}

}  // namespace robot_vision
