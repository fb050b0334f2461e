#include "sphere_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "region_rays.hpp"

namespace robot_vision
{
namespace
{

cv::Vec3d directionOf(const CameraModel& camera, const cv::Point2d& pixel)
{
  const cv::Point2d ray = rayThrough(camera, pixel);
  return cv::normalize(cv::Vec3d(ray.x, ray.y, 1.0));
}

}  // namespace

SphereView sphereView(const CameraModel& camera, const cv::Point2d& center, double radius)
{
  SphereView view;
  view.axis = directionOf(camera, center);
  const std::array<cv::Point2d, 4> rim = {cv::Point2d(radius, 0.0), cv::Point2d(-radius, 0.0), cv::Point2d(0.0, radius),
                                          cv::Point2d(0.0, -radius)};
  for (const cv::Point2d& off : rim)
  {
    const cv::Vec3d direction = directionOf(camera, center + off);
    view.radius += std::atan2(cv::norm(view.axis.cross(direction)), view.axis.dot(direction)) / rim.size();
  }
  return view;
}

std::optional<double> sphereDistance(const std::vector<RegionSample>& samples, const CameraModel& camera,
                                     const SphereView& view)
{
  const double square = std::pow(std::cos(view.radius), 2);
  std::vector<double> distances;
  for (const RegionSample& sample : samples)
  {
    const cv::Point2d ray = camera.ray(cv::Point2d(sample.x, sample.y));
    if (std::isnan(ray.x)) continue;
    const cv::Vec3d point = static_cast<double>(sample.depth) * cv::Vec3d(ray.x, ray.y, 1.0);
    // The point p is as far from the middle d * axis as the rim's tangents are: |p - d axis| = d sin(radius).
    const double along = point.dot(view.axis), root = along * along - square * point.dot(point);
    if (root >= 0.0) distances.push_back((along + std::sqrt(root)) / square);
  }
  if (distances.empty()) return std::nullopt;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

}  // namespace robot_vision
