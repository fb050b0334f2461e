#include "depth_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/depth/depth_pixel.hpp"
#include "robot_vision/depth/depth_error.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMargin = 1.0;       // px between a tag's edge and the depths that are used
constexpr double kMaxSamples = 2000;  // of a tag; more take time, and make the plane no better than its bias

using Quad = std::array<cv::Point2d, 4>;

/// Whether a pixel is in the quad, counter-clockwise in an image whose y points down, and so far from its edges.
bool isInside(const Quad& quad, const cv::Point2d& pixel, double margin)
{
  for (std::size_t i = 0; i < quad.size(); ++i)
  {
    const cv::Point2d along = quad[(i + 1) % quad.size()] - quad[i];
    if ((pixel - quad[i]).cross(along) < margin * cv::norm(along)) return false;
  }
  return true;
}

}  // namespace

cv::Size depthStride(const Quad& quad)
{
  const double area = std::abs((quad[2] - quad[0]).cross(quad[3] - quad[1])) / 2.0;
  const int across = std::max(cvFloor(std::sqrt(area / kMaxSamples)), 1);
  return {across, std::max(cvCeil(area / kMaxSamples / across), 1)};
}

std::vector<DepthSample> depthSamples(const cv::Mat& depth, const Quad& quad, const cv::Size& stride,
                                      const CameraModel& camera, const DepthErrorParams& params)
{
  const auto [left, right] = std::minmax({quad[0].x, quad[1].x, quad[2].x, quad[3].x});
  const auto [top, bottom] = std::minmax({quad[0].y, quad[1].y, quad[2].y, quad[3].y});
  const int end_x = std::min(cvFloor(right) + 1, depth.cols);
  const int end_y = std::min(cvFloor(bottom) + 1, depth.rows);
  std::vector<DepthSample> samples;
  for (int y = std::max(cvCeil(top), 0); y < end_y; y += stride.height)
    for (int x = std::max(cvCeil(left), 0); x < end_x; x += stride.width)
    {
      const cv::Point2d pixel(x, y);
      const double z = depthAt(depth, x, y);
      if (std::isnan(z) || !isInside(quad, pixel, kMargin)) continue;
      const cv::Point2d ray = camera.ray(pixel);
      if (std::isnan(ray.x)) continue;
      samples.push_back({{ray.x, ray.y, 1.0}, 1.0 / z, depthDeviation(z, params) / (z * z)});
    }
  return samples;
}

}  // namespace robot_vision
