#include "scene_painter.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision::scene
{

namespace
{

// Picks the finest level whose texels are a little larger than a pixel. So nothing flickers, and every edge is a ramp
// that shows its sub-pixel position, as it is behind a real lens. `plane` maps rays to the unit square of the texture.
const TextureLevel& pickLevel(const Texture& texture, const cv::Matx33f& plane, float x, float y, float focal)
{
  const cv::Vec3f p = plane * cv::Vec3f(x, y, 1.0F);
  const float u = p[0] / p[2], v = p[1] / p[2];
  const float step = 1.0F / (focal * p[2]);  // change of a ray from pixel to pixel, divided by the depth term
  const std::vector<cv::Size>& sizes = texture.sizes();
  const auto width = static_cast<float>(sizes.front().width), height = static_cast<float>(sizes.front().height);
  const auto texels = [&](int axis)
  {
    const float du = (plane(0, axis) - u * plane(2, axis)) * step * width;
    const float dv = (plane(1, axis) - v * plane(2, axis)) * step * height;
    return std::sqrt(du * du + dv * dv);
  };
  const float min_texel_size = 1.15F;  // px
  const float max_width = width / (min_texel_size * std::max(texels(0), texels(1)));
  std::size_t level = 0;
  while (level + 1 < sizes.size() && static_cast<float>(sizes[level].width) > max_width)
    ++level;
  return texture.level(level);
}

}  // namespace

cv::Matx33d rayToPlane(const cv::Affine3d& pose)
{
  const cv::Matx33d R = pose.rotation();
  const cv::Vec3d t = pose.translation();
  const cv::Matx33d plane(R(0, 0), R(0, 1), t[0], R(1, 0), R(1, 1), t[1], R(2, 0), R(2, 1), t[2]);
  return plane.inv(cv::DECOMP_LU);
}

RowSpans rowSpans(const Polygon2& polygon, const CameraModel& camera)
{
  const int margin = 2;
  RowSpans result;
  if (polygon.empty()) return result;
  const auto row_of = [&](double y, int extra)
  { return static_cast<int>(std::clamp(std::floor(y) + extra, 0.0, static_cast<double>(camera.height))); };
  const auto column_of = [&](double x, int extra)
  { return static_cast<int>(std::clamp(std::floor(x) + extra, 0.0, static_cast<double>(camera.width))); };
  const auto y_range = std::minmax_element(polygon.begin(), polygon.end(),
                                           [](const cv::Point2d& a, const cv::Point2d& b) { return a.y < b.y; });
  result.top = row_of(y_range.first->y, -margin);
  result.spans.assign(row_of(y_range.second->y, margin + 1) - result.top, cv::Point(camera.width, 0));
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const cv::Point2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double low = std::min(a.y, b.y), high = std::max(a.y, b.y);
    const double slope = high > low ? (b.x - a.x) / (b.y - a.y) : 0.0;
    for (int row = row_of(low, -margin); row < row_of(high, margin + 1); ++row)
    {
      // The ends of the part of this edge that lies within the margin of the row. A horizontal edge counts as a whole.
      const double from = high > low ? a.x + slope * (std::clamp(row - 1.0 * margin, low, high) - a.y) : a.x;
      const double to = high > low ? a.x + slope * (std::clamp(row + 1.0 * margin, low, high) - a.y) : b.x;
      cv::Point& span = result.spans[row - result.top];
      span.x = std::min(span.x, column_of(std::min(from, to), -margin));
      span.y = std::max(span.y, column_of(std::max(from, to), margin + 1));
    }
  }
  return result;
}

RowSpans boardSpans(const cv::Affine3d& pose, const cv::Size2d& size, const Lens& lens)
{
  const int pieces = 12;  // of each edge, which the lens bends
  return rowSpans(project(clipToView(corners(pose, size), lens), lens.camera, pieces), lens.camera);
}

void paintSky(const cv::Scalar& color, const cv::Affine3d& ground, const Lens& lens, cv::Mat& bgr)
{
  const cv::Matx33d plane = rayToPlane(ground);
  const double most = std::abs(plane(2, 0)) * lens.max_x + std::abs(plane(2, 1)) * lens.max_y;
  if (plane(2, 2) > most) return;  // no ray is above the horizon
  bgr.setTo(color, plane(2, 0) * lens.rays.x + plane(2, 1) * lens.rays.y <= -plane(2, 2));
}

void paintBoard(const Texture& texture, const cv::Affine3d& pose, const cv::Size2d& size, const Lens& lens,
                DrawTexture draw, cv::Mat& bgr)
{
  if (!facesCamera(pose)) return;
  const RowSpans rows = boardSpans(pose, size, lens);
  // Maps metres from the middle with y up to the unit square with y down.
  const cv::Matx33d to_unit(1.0 / size.width, 0, 0.5, 0, -1.0 / size.height, 0.5, 0, 0, 1);
  const cv::Matx33f plane = to_unit * rayToPlane(pose);
  const auto focal = static_cast<float>(lens.camera.K(0, 0));
  TexturePlane view = {};
  std::copy(plane.val, plane.val + 9, view.plane);
  for (std::size_t i = 0; i < rows.spans.size(); ++i)
  {
    const int row = rows.top + static_cast<int>(i), end = rows.spans[i].y;
    const float* xs = lens.rays.x.ptr<float>(row);
    const float* ys = lens.rays.y.ptr<float>(row);
    for (int column = rows.spans[i].x; column < end; column += TextureKernels::kMaxRun)
    {
      // A run is drawn with one level of the texture.
      const int count = std::min(TextureKernels::kMaxRun, end - column), middle = column + count / 2;
      const TextureLevel& level = pickLevel(texture, plane, xs[middle], ys[middle], focal);
      view.texels = level.texels.data();
      view.width = level.width;
      view.height = level.height;
      draw(view, xs + column, ys + column, count, bgr.ptr(row) + 3 * column);
    }
  }
}

}  // namespace robot_vision::scene
