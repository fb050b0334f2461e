#include "rendered_region.hpp"

#include <algorithm>
#include <cmath>

#include "core/image/rects.hpp"

namespace robot_vision
{
namespace
{

constexpr double kNearest = 0.01;  // m, that all of an object must be in front of the camera
constexpr int kBorder = 3;         // drawn pixels around the object, in which its contour ends

}  // namespace

int drawnPixels(const MeshView& view)
{
  int drawn = 0;
  for (int y = 0; y < view.depth.rows; ++y)
  {
    const auto* const row = view.depth.ptr<float>(y);
    drawn += static_cast<int>(std::count_if(row, row + view.depth.cols, [](float z) { return z > 0.0F; }));
  }
  return drawn;
}

cv::Rect projectedBox(const MeshExtent& extent, const cv::Affine3d& pose, const cv::Matx33d& K, const cv::Size& image)
{
  const Pinhole camera(K);
  double left = image.width, top = image.height, right = -1.0, bottom = -1.0;
  for (int corner = 0; corner < 8; ++corner)
  {
    cv::Vec3d point = extent.center;
    for (int i = 0; i < 3; ++i)
      point[i] += ((corner >> i & 1) != 0 ? 0.5 : -0.5) * extent.size[i];
    point = pose * point;
    if (!(point[2] > kNearest)) return {};
    const cv::Point2d pixel = camera.project(point);
    left = std::min(left, pixel.x);
    top = std::min(top, pixel.y);
    right = std::max(right, pixel.x);
    bottom = std::max(bottom, pixel.y);
  }
  if (!(left <= image.width - 1.0 && top <= image.height - 1.0 && right >= 0.0 && bottom >= 0.0)) return {};
  const auto first = [](double position) { return static_cast<int>(std::ceil(std::max(position, 0.0))); };
  const auto last = [](double position, int size) { return static_cast<int>(std::min(position, size - 1.0)); };
  const int x = first(left), y = first(top);
  return {x, y, std::max(last(right, image.width) - x + 1, 0), std::max(last(bottom, image.height) - y + 1, 0)};
}

bool drawRegion(const ObjectShape& shape, const cv::Affine3d& pose, const cv::Matx33d& K, const cv::Size& image,
                int max_pixels, const RenderParts& parts, RenderedRegion& region)
{
  const cv::Rect box = projectedBox(shape.extent(), pose, K, image);
  if (box.empty()) return false;
  region.step = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(box.area()) / max_pixels))));
  region.box = grown(box, kBorder * region.step, image);
  region.pose = pose;
  region.center = pose * shape.extent().center;
  const double s = region.step;
  region.camera = Pinhole(
      {K(0, 0) / s, K(0, 1) / s, (K(0, 2) - region.box.x) / s, 0, K(1, 1) / s, (K(1, 2) - region.box.y) / s, 0, 0, 1});
  const cv::Size size((region.box.width + region.step - 1) / region.step,
                      (region.box.height + region.step - 1) / region.step);
  shape.renderer().render(region.K(), pose, {{0, 0}, size}, region.view, parts);
  return true;
}

}  // namespace robot_vision
