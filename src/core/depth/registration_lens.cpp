#include "registration_lens.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/distortion.hpp"
#include "robot_vision/geometry/distortion_models.hpp"

namespace robot_vision
{
namespace
{

constexpr int kBorderPoints = 32;               // on each side of the image
constexpr int kDirections = 16;                 // from the axis
constexpr int kAngles = 1000;                   // between the axis and what is seen at the border
constexpr double kWidest = 89.0 * CV_PI / 180;  // rad, from the axis

/// The largest angle (rad) from the axis at which something is seen around the image.
double widestAngle(const CameraModel& camera, double margin)
{
  const double right = camera.width - 1 + 2.0 * margin, down = camera.height - 1 + 2.0 * margin;
  double widest = 0.0;
  for (int i = 0; i <= kBorderPoints; ++i)
  {
    const double share = static_cast<double>(i) / kBorderPoints;
    for (const cv::Point2d& at :
         {cv::Point2d(share, 0.0), cv::Point2d(share, 1.0), cv::Point2d(0.0, share), cv::Point2d(1.0, share)})
    {
      const cv::Point2d ray = camera.ray({at.x * right - margin, at.y * down - margin});
      if (std::isnan(ray.x)) return kWidest;  // the lens ends inside of the image
      widest = std::max(widest, std::atan(std::hypot(ray.x, ray.y)));
    }
  }
  return std::min(widest, kWidest);
}

LensKind kindOf(const CameraModel& camera)
{
  if (isEquidistant(camera.distortion_model)) return LensKind::kEquidistant;
  const auto is_zero = [](double k) { return k == 0.0; };
  if (std::all_of(camera.D.begin(), camera.D.end(), is_zero)) return LensKind::kPinhole;
  return camera.D.size() > 5 ? LensKind::kRational : LensKind::kPolynomial;
}

}  // namespace

double lensRadius(const CameraModel& camera, double margin)
{
  const Undistortion lens(camera);
  const double widest = widestAngle(camera, margin);
  double radius = 0.0;
  for (int step = 1; step <= kAngles; ++step)
  {
    const double next = std::tan(widest * step / kAngles);
    for (int i = 0; i < kDirections; ++i)
    {
      const double direction = 2.0 * CV_PI * i / kDirections;
      const cv::Point2d point(next * std::cos(direction), next * std::sin(direction));
      if (!lens.holds(point)) return radius;
    }
    radius = next;
  }
  return radius;
}

Projection32 projection32(const CameraModel& camera, const cv::Affine3d& to_camera, double radius)
{
  const auto single = [](double value) { return static_cast<float>(value); };
  Projection32 result{};
  result.kind = kindOf(camera);
  const cv::Matx33d rotation = to_camera.rotation();
  const cv::Vec3d translation = to_camera.translation();
  std::transform(rotation.val, rotation.val + 9, result.rotation, single);
  std::transform(translation.val, translation.val + 3, result.translation, single);
  std::transform(camera.D.begin(), camera.D.end(), result.k, single);
  result.fx = single(camera.K(0, 0));
  result.skew = single(camera.K(0, 1));
  result.cx = single(camera.K(0, 2));
  result.fy = single(camera.K(1, 1));
  result.cy = single(camera.K(1, 2));
  result.max_radius = single(radius);
  return result;
}

}  // namespace robot_vision
