#include "scene_view.hpp"

#include <algorithm>
#include <cmath>

#include "robot_vision/scene/scene.hpp"

namespace robot_vision::scene
{

namespace
{

// Clips a polygon by Sutherland and Hodgman's method: it keeps the part where `distance` is not negative. `distance`
// must be linear in the point.
template <typename Point, typename Distance>
std::vector<Point> clip(const std::vector<Point>& polygon, Distance distance)
{
  std::vector<Point> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Point& from = polygon[i];
    const Point& to = polygon[(i + 1) % polygon.size()];
    const double a = distance(from), b = distance(to);
    if (a >= 0.0) kept.push_back(from);
    if ((a >= 0.0) != (b >= 0.0)) kept.push_back(from + (to - from) * (a / (a - b)));
  }
  return kept;
}

double cross(const cv::Point2d& o, const cv::Point2d& a, const cv::Point2d& b)
{
  return (a - o).cross(b - o);
}

bool segmentsCross(const cv::Point2d& a, const cv::Point2d& b, const cv::Point2d& c, const cv::Point2d& d)
{
  return cross(a, b, c) * cross(a, b, d) < 0.0 && cross(c, d, a) * cross(c, d, b) < 0.0;
}

bool contains(const Polygon2& polygon, const cv::Point2d& point)
{
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++)
  {
    const cv::Point2d &a = polygon[i], &b = polygon[j];
    if ((a.y > point.y) == (b.y > point.y)) continue;
    if (point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)) inside = !inside;
  }
  return inside;
}

}  // namespace

Lens::Lens(const CameraModel& model) : camera(model), rays(rayTable(model)), for_meshes(model)
{
  const double margin = 1.1;  // keeps the cut edges of clipped shapes out of the image
  max_x = margin * std::max(cv::norm(rays.x, cv::NORM_INF), 0.05);
  max_y = margin * std::max(cv::norm(rays.y, cv::NORM_INF), 0.05);
}

CameraModel sceneCamera(int width, int height)
{
  const double focal_per_height = 1.16;  // a vertical field of view of some 47 degrees
  CameraModel camera;
  camera.width = width;
  camera.height = height;
  const double focal = focal_per_height * std::min<double>(height, 0.75 * width);
  camera.K = {focal, 0, (width - 1) / 2.0 + 0.004 * width, 0, focal, (height - 1) / 2.0 - 0.003 * height, 0, 0, 1};
  // With these the distorted radius grows steadily with the undistorted one, so every pixel has exactly one ray.
  camera.D = {-0.12, 0.05, 0.0006, -0.0004, 0.0};
  return camera;
}

Polygon3 corners(const cv::Affine3d& pose, const cv::Size2d& size)
{
  const double x = size.width / 2.0, y = size.height / 2.0;
  Polygon3 result;
  for (const cv::Point3d& corner : {cv::Point3d(-x, -y, 0), {x, -y, 0}, {x, y, 0}, {-x, y, 0}})
    result.push_back(pose * corner);
  return result;
}

bool facesCamera(const cv::Affine3d& pose)
{
  const cv::Vec3d out = pose.rotation() * cv::Vec3d(0, 0, 1);
  return out.dot(pose.translation()) < 0.0;
}

Polygon2 ballOutline(const CameraModel& camera, const cv::Point3d& center, double radius, int points)
{
  // The rays that touch the ball form a cone around the ray to its centre.
  const double distance = cv::norm(center), sine = radius / distance, cosine = std::sqrt(1.0 - sine * sine);
  const cv::Vec3d axis = cv::Vec3d(center) / distance;
  const cv::Vec3d right = cv::normalize(cv::Vec3d(0, 1, 0).cross(axis)), down = axis.cross(right);
  Polygon2 outline;
  for (int i = 0; i < points; ++i)
  {
    const double angle = 2.0 * CV_PI * i / points;
    const cv::Vec3d ray = cosine * axis + sine * (std::cos(angle) * right + std::sin(angle) * down);
    outline.push_back(camera.project(cv::Point3d(ray)));
  }
  return outline;
}

Polygon3 lineOutline(const cv::Affine3d& world_in_camera)
{
  const int pieces = 32;
  Polygon3 outline;
  for (int i = 0; i <= 2 * pieces + 1; ++i)
  {
    const bool right = i <= pieces;  // the outline runs away along the right edge and back along the left one
    const double part = static_cast<double>(right ? i : 2 * pieces + 1 - i) / pieces;
    const double forward = kLineBegin + part * (kLineEnd - kLineBegin);
    const double left = lineCenter(forward) + (right ? -0.5 : 0.5) * kSceneLineWidth;
    outline.push_back(world_in_camera * cv::Point3d(forward, left, 0));
  }
  return outline;
}

Polygon3 clipToView(const Polygon3& polygon, const Lens& lens)
{
  Polygon3 kept = clip(polygon, [&](const cv::Point3d& p) { return lens.max_x * p.z - p.x; });
  kept = clip(kept, [&](const cv::Point3d& p) { return lens.max_x * p.z + p.x; });
  kept = clip(kept, [&](const cv::Point3d& p) { return lens.max_y * p.z - p.y; });
  return clip(kept, [&](const cv::Point3d& p) { return lens.max_y * p.z + p.y; });
}

Polygon2 clipToImage(const Polygon2& polygon, const CameraModel& camera)
{
  const double right = camera.width - 0.5, bottom = camera.height - 0.5;
  Polygon2 kept = clip(polygon, [](const cv::Point2d& p) { return p.x + 0.5; });
  kept = clip(kept, [](const cv::Point2d& p) { return p.y + 0.5; });
  kept = clip(kept, [=](const cv::Point2d& p) { return right - p.x; });
  return clip(kept, [=](const cv::Point2d& p) { return bottom - p.y; });
}

Polygon2 project(const Polygon3& polygon, const CameraModel& camera, int pieces)
{
  Polygon2 outline;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const cv::Point3d& from = polygon[i];
    const cv::Point3d& to = polygon[(i + 1) % polygon.size()];
    for (int piece = 0; piece < pieces; ++piece)
      outline.push_back(camera.project(from + (to - from) * (static_cast<double>(piece) / pieces)));
  }
  return outline;
}

bool insideImage(const Polygon2& outline, const CameraModel& camera)
{
  return !outline.empty() &&
         std::all_of(outline.begin(), outline.end(),
                     [&](const cv::Point2d& p)
                     { return p.x >= -0.5 && p.y >= -0.5 && p.x <= camera.width - 0.5 && p.y <= camera.height - 0.5; });
}

bool overlap(const Polygon2& a, const Polygon2& b)
{
  if (a.empty() || b.empty()) return false;
  if (contains(a, b.front()) || contains(b, a.front())) return true;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    for (std::size_t j = 0; j < b.size(); ++j)
    {
      if (segmentsCross(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()])) return true;
    }
  }
  return false;
}

}  // namespace robot_vision::scene
