#include "sphere_distance.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "region_rays.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxRadius = 1.2;  // rad, of a sphere as it is seen

cv::Vec3d directionOf(const CameraModel& camera, const cv::Point2d& pixel)
{
  const cv::Point2d ray = rayThrough(camera, pixel);
  return cv::normalize(cv::Vec3d(ray.x, ray.y, 1.0));
}

/// The mean of the angles between an axis and the rays at both sides of its pixel, rad.
double meanAngle(const CameraModel& camera, const cv::Vec3d& axis, const cv::Point2d& center, const cv::Point2d& off)
{
  double sum = 0.0;
  for (const cv::Point2d& pixel : {center + off, center - off})
  {
    const cv::Vec3d direction = directionOf(camera, pixel);
    sum += std::atan2(cv::norm(axis.cross(direction)), axis.dot(direction));
  }
  return sum / 2.0;
}

}  // namespace

SphereView sphereView(const CameraModel& camera, const cv::Point2d& center, double radius)
{
  SphereView view;
  view.axis = directionOf(camera, center);
  const cv::Point2d out = center - camera.project({0.0, 0.0, 1.0});
  const double length = cv::norm(out);
  const cv::Point2d radial = length > 0.0 ? out * (radius / length) : cv::Point2d(radius, 0.0);
  // Beside the optical axis a sphere is seen as an ellipse, which the circle encloses: it touches the rim where the
  // angle is smaller.
  view.radius = std::min(meanAngle(camera, view.axis, center, radial),
                         meanAngle(camera, view.axis, center, {-radial.y, radial.x}));
  require(view.radius <= kMaxRadius, "the radius", radius, "that of a sphere which is seen in one image");
  return view;
}

std::optional<double> sphereDistance(const std::vector<RegionSample>& samples, const CameraModel& camera,
                                     const SphereView& view)
{
  const double square = std::pow(std::cos(view.radius), 2);
  std::vector<double> distances;
  const std::size_t step = (samples.size() + kMaxSphereSamples - 1) / kMaxSphereSamples;
  for (std::size_t i = 0; i < samples.size(); i += step)
  {
    const RegionSample& sample = samples[i];
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
