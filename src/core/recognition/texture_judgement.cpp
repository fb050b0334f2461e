#include "texture_judgement.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "texture_places.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxAlarms = 300.0;  // decadic logarithm of what is as improbable as can be told
constexpr double kMaxByChance = 0.5;  // probability that a match agrees by chance

/// The decadic logarithm of how many poses are expected with which `inliers` of `matches` agree by chance, if one does
/// with a probability.
double falseAlarms(int matches, int inliers, double probability)
{
  const auto choices = [](int n, int k)
  { return (std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0)) / std::log(10.0); };
  return std::log10(4.0 * std::max(matches - 3, 1)) + choices(matches, inliers) + choices(inliers, 3) +
         (inliers - 3) * std::log10(probability);
}

/// The box around the corners of an extent; empty if one of them is not in front of the camera.
cv::Rect boxOf(const CameraModel& camera, const cv::Affine3d& pose, const MeshExtent& extent)
{
  std::vector<cv::Point2f> corners;
  for (int i = 0; i < 8; ++i)
  {
    const cv::Vec3d sides((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2 & 1) - 0.5);
    const cv::Point2d pixel = camera.project(cv::Point3d(pose * (extent.center + extent.size.mul(sides))));
    if (!std::isfinite(pixel.x) || !std::isfinite(pixel.y)) return {};
    corners.emplace_back(pixel);
  }
  return cv::boundingRect(corners);
}

}  // namespace

TexturedObject judgeTexture(const std::vector<TextureMatch>& matches, const std::vector<std::size_t>& candidates,
                            const TextureFit& fit, int model, const MeshExtent& extent, const CameraModel& camera)
{
  const cv::Affine3d& pose = fit.found.pose;
  const cv::Vec3d center = pose * extent.center;
  const cv::Point2d middle(center[0] / center[2], center[1] / center[2]);
  const double radius = extent.radius / center[2];
  TexturedObject object;
  for (const std::size_t i : candidates)
    object.matches += cv::norm(matches[i].ray - middle) <= radius ? 1 : 0;
  double squares = 0.0, tolerance = 0.0;
  for (const std::size_t i : fit.found.inliers)
  {
    const cv::Vec3d point = pose * matches[i].point;
    const cv::Point2d error = matches[i].ray - cv::Point2d(point[0] / point[2], point[1] / point[2]);
    squares += error.dot(error);
    tolerance += matches[i].tolerance;
  }
  const auto count = static_cast<double>(fit.found.inliers.size());
  object.inliers = countPlaces(matches, fit.found.inliers, extent.diameter);
  object.matches = std::max(object.matches, object.inliers);
  object.error = std::sqrt(camera.K(0, 0) * camera.K(1, 1) * squares / count);
  object.covariance = fit.covariance;
  object.depth_agreement = fit.depth_agreement;
  const double by_chance = std::min(std::pow(tolerance / count / radius, 2.0), kMaxByChance);
  const double alarms = std::min(falseAlarms(object.matches, object.inliers, by_chance), kMaxAlarms);
  object.probability = fit.probability / (1.0 + std::pow(10.0, alarms));
  if (!std::isnan(fit.depth_agreement)) object.probability *= fit.depth_agreement;
  const double score = static_cast<double>(object.inliers) / object.matches;
  object.candidate = {model, pose, score, boxOf(camera, pose, extent), 0};
  return object;
}

}  // namespace robot_vision
