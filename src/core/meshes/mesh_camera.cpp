#include "mesh_camera.hpp"

#include <algorithm>
#include <cmath>

#include "core/meshes/raster_kernels.hpp"
#include "robot_vision/geometry/distortion_models.hpp"

namespace robot_vision
{
namespace
{

constexpr int kCells = 96;  // in both directions

double sineOf(double tangent)
{
  return tangent / std::sqrt(1.0 + tangent * tangent);
}

double tangentOf(double sine)
{
  return sine / std::sqrt(1.0 - sine * sine);
}

/// How many cells there are from the first node to a tangent. Beyond the last nodes this is linear in the tangent, so
/// that straight lines stay straight there.
double cellsFrom(double first, double step, double tangent)
{
  const double cells = (sineOf(tangent) - first) / step;
  if (cells >= 0.0 && cells <= kCells) return cells;
  const int end = cells < 0.0 ? 0 : kCells, inner = cells < 0.0 ? 1 : kCells - 1;
  const double border = tangentOf(first + end * step), before = tangentOf(first + inner * step);
  return end + (end - inner) * (tangent - border) / (border - before);
}

/// The lowest and highest of all rays along one axis.
cv::Vec2d rangeOf(const cv::Mat& rays)
{
  cv::Vec2d range;
  cv::minMaxLoc(rays, &range[0], &range[1]);
  return {std::min(range[0], 0.0), std::max(range[1], 0.0)};
}

}  // namespace

MeshCamera::MeshCamera(const cv::Matx33d& K) : K_(K)
{
  CameraModel camera;
  camera.width = camera.height = 1;
  camera.K = K;
  validate(camera);
}

MeshCamera::MeshCamera(const CameraModel& camera) : K_(camera.K)
{
  validate(camera);
  if (isDistorted(camera)) lens_ = std::make_shared<const Lens>(camera);
}

MeshCamera::Lens::Lens(const CameraModel& camera) : size(camera.width, camera.height)
{
  RayTable rays = rayTable(camera);
  const cv::Mat none = rays.x != rays.x;
  rays.x.setTo(0.0, none);
  rays.y.setTo(0.0, none);
  if (cv::countNonZero(none) > 0) unseen = none;
  cv::copyMakeBorder(rays.x, xs, 0, 0, 0, Raster::kLanes, cv::BORDER_CONSTANT, 0.0);
  cv::copyMakeBorder(rays.y, ys, 0, 0, 0, Raster::kLanes, cv::BORDER_CONSTANT, 0.0);
  const cv::Vec2d x_range = rangeOf(rays.x), y_range = rangeOf(rays.y);
  const cv::Point2d low(sineOf(x_range[0]), sineOf(y_range[0])), high(sineOf(x_range[1]), sineOf(y_range[1]));
  step_ = cv::Point2d(std::max(high.x - low.x, 1e-3), std::max(high.y - low.y, 1e-3)) / kCells;
  first_ = low;
  nodes_.create(kCells + 1, kCells + 1, CV_64FC2);
  for (int row = 0; row < nodes_.rows; ++row)
    for (int column = 0; column < nodes_.cols; ++column)
      nodes_.at<cv::Point2d>(row, column) =
          camera.project({tangentOf(first_.x + column * step_.x), tangentOf(first_.y + row * step_.y), 1.0});
  measure(camera);
}

void MeshCamera::Lens::measure(const CameraModel& camera)
{
  double error = 0.0, curvature = 0.0;
  for (int row = 0; row < kCells; ++row)
    for (int column = 0; column < kCells; ++column)
    {
      const cv::Point2d sines(first_.x + (column + 0.5) * step_.x, first_.y + (row + 0.5) * step_.y);
      const cv::Point2d ray(tangentOf(sines.x), tangentOf(sines.y));
      const cv::Point2d half(tangentOf(sines.x + step_.x / 2.0) - ray.x, tangentOf(sines.y + step_.y / 2.0) - ray.y);
      const auto at = [&](double x, double y) { return camera.project({ray.x + x * half.x, ray.y + y * half.y, 1.0}); };
      const cv::Point2d here = at(0, 0);
      error = std::max(error, cv::norm(pixel(ray.x, ray.y) - here));
      for (const cv::Point2d& way : {cv::Point2d(1, 0), cv::Point2d(0, 1), cv::Point2d(1, 1), cv::Point2d(1, -1)})
      {
        const cv::Point2d before = at(-way.x, -way.y), after = at(way.x, way.y), along = after - before;
        curvature = std::max(curvature, cv::norm(before + after - 2.0 * here) / along.dot(along));
      }
    }
  const double safety = 2.0;
  margin = 0.1 + safety * error;
  // A curve of length s is second derivative * s^2 / 8 away from its chord; `along` are two steps of the differences.
  bend = safety * curvature * 4.0 / 8.0;
}

cv::Point2d MeshCamera::Lens::pixel(double x, double y) const
{
  const double column = cellsFrom(first_.x, step_.x, x), row = cellsFrom(first_.y, step_.y, y);
  const int left = static_cast<int>(std::clamp(column, 0.0, kCells - 1.0));
  const int top = static_cast<int>(std::clamp(row, 0.0, kCells - 1.0));
  const double right_part = column - left, lower_part = row - top;
  const cv::Point2d upper = node(left, top) + (node(left + 1, top) - node(left, top)) * right_part;
  const cv::Point2d lower = node(left, top + 1) + (node(left + 1, top + 1) - node(left, top + 1)) * right_part;
  return upper + (lower - upper) * lower_part;
}

}  // namespace robot_vision
