#include "mesh_raster.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

namespace robot_vision
{
SeenBounds bend(const MeshCamera::Lens& lens, const cv::Point& corner, double min_w, std::vector<SeenVertex>& seen)
{
  const double most = std::numeric_limits<double>::max();
  SeenBounds bounds = {min_w, most, -most, most, -most};
  for (SeenVertex& vertex : seen)
  {
    if (vertex.w < MeshRenderer::kNearest) continue;
    const cv::Point2d pixel = lens.pixel(vertex.x / vertex.w, vertex.y / vertex.w) - cv::Point2d(corner);
    vertex.u = static_cast<float>(pixel.x);
    vertex.v = static_cast<float>(pixel.y);
    bounds.min_u = std::min(bounds.min_u, pixel.x);
    bounds.max_u = std::max(bounds.max_u, pixel.x);
    bounds.min_v = std::min(bounds.min_v, pixel.y);
    bounds.max_v = std::max(bounds.max_v, pixel.y);
  }
  return bounds;
}

cv::Rect seenPart(const SeenBounds& bounds, const SeenTriangles& triangles, const cv::Size& region)
{
  if (bounds.min_w < triangles.nearest) return {cv::Point(), region};
  const double size = std::max(bounds.max_u - bounds.min_u, bounds.max_v - bounds.min_v);
  const double margin = triangles.margin + triangles.bend * size * size;
  const auto within = [](double x, int count)
  { return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(count))); };
  const int left = within(std::floor(bounds.min_u - margin), region.width);
  const int top = within(std::floor(bounds.min_v - margin), region.height);
  const int right = within(std::floor(bounds.max_u + margin) + 1, region.width);
  const int bottom = within(std::floor(bounds.max_v + margin) + 1, region.height);
  return {left, top, right - left, bottom - top};
}

Raster makeRaster(const MeshCamera& camera, const cv::Rect& region, const cv::Rect& part, const cv::Mat& depth,
                  MeshView::Scratch& scratch)
{
  const int columns = (part.width + Raster::kLanes - 1) / Raster::kLanes * Raster::kLanes;
  const std::size_t size = static_cast<std::size_t>(columns) * static_cast<std::size_t>(part.height);
  scratch.inverse.assign(size, 0.0F);
  scratch.drawn.assign(size, -1);
  for (int row = 0; row < part.height; ++row)
  {
    const float* from = depth.ptr<float>(part.y + row) + part.x;
    std::transform(from, from + part.width, scratch.inverse.begin() + static_cast<std::ptrdiff_t>(row) * columns,
                   [](float z) { return z > 0.0F ? 1.0F / z : 0.0F; });
  }
  Raster raster = {part.x,  part.y,  columns, part.height, scratch.inverse.data(), scratch.drawn.data(),
                   nullptr, nullptr, 0};
  if (const MeshCamera::Lens* lens = camera.lens())
  {
    const cv::Point first = region.tl() + part.tl();
    raster.xs = &lens->xs.at<float>(first);
    raster.ys = &lens->ys.at<float>(first);
    raster.ray_step = static_cast<std::ptrdiff_t>(lens->xs.step1());
    return raster;
  }
  scratch.columns.resize(static_cast<std::size_t>(columns));
  std::iota(scratch.columns.begin(), scratch.columns.end(), static_cast<float>(part.x));
  raster.xs = scratch.columns.data();
  return raster;
}

void dropUnseen(const MeshCamera& camera, const cv::Point& corner, const cv::Rect& part, const Raster& raster)
{
  const cv::Mat& unseen = camera.lens()->unseen;
  if (unseen.empty()) return;
  for (int row = 0; row < part.height; ++row)
  {
    const uchar* none = &unseen.at<uchar>(corner + part.tl() + cv::Point(0, row));
    for (int column = 0; column < part.width; ++column)
      if (none[column] != 0) raster.drawn[static_cast<std::ptrdiff_t>(row) * raster.columns + column] = -1;
  }
}

}  // namespace robot_vision
