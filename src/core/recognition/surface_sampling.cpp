#include "surface_sampling.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{
namespace
{

constexpr double kDensity = 8.0;      // points that are offered for each square of the distance
constexpr int kMaxOffered = 2000000;  // of a mesh

/// The fractions of a sequence whose points fill the unit square evenly (R2, Martin Roberts).
cv::Vec2d evenly(int i)
{
  const double x = 0.5 + 0.7548776662466927 * i, y = 0.5 + 0.5698402909980532 * i;
  return {x - std::floor(x), y - std::floor(y)};
}

/// The unit vector, or zero for what has no direction.
cv::Vec3f unit(const cv::Vec3f& vector)
{
  const double length = cv::norm(vector);
  return length > 1e-20 ? cv::Vec3f(cv::Vec3d(vector) * (1.0 / length)) : cv::Vec3f();
}

}  // namespace

OrientedPoints sampleSurface(const Mesh& mesh, double distance)
{
  std::vector<double> areas;  // of all triangles up to one
  double area = 0.0;
  const auto cornerOf = [&](const cv::Vec3i& triangle, int i)
  { return mesh.vertices[static_cast<std::size_t>(triangle[i])]; };
  const auto crossOf = [&](const cv::Vec3i& triangle)
  {
    const cv::Vec3f a = cornerOf(triangle, 0);
    return (cornerOf(triangle, 1) - a).cross(cornerOf(triangle, 2) - a);
  };
  for (const cv::Vec3i& triangle : mesh.triangles)
    areas.push_back(area += 0.5 * cv::norm(crossOf(triangle)));
  const int offered =
      static_cast<int>(std::min<double>(kMaxOffered, std::ceil(kDensity * area / (distance * distance))));
  PointThinning thinning;
  thinning.begin(distance);
  for (int i = 0; i < offered; ++i)
  {
    const double place = area * (i + 0.5) / offered;
    const auto at = std::min(std::upper_bound(areas.begin(), areas.end(), place), areas.end() - 1) - areas.begin();
    const cv::Vec3i& triangle = mesh.triangles[static_cast<std::size_t>(at)];
    cv::Vec2d share = evenly(i);
    if (share[0] + share[1] > 1.0) share = cv::Vec2d(1.0, 1.0) - share;
    const auto u = static_cast<float>(share[0]), v = static_cast<float>(share[1]);
    const cv::Vec3f a = cornerOf(triangle, 0), b = cornerOf(triangle, 1), c = cornerOf(triangle, 2);
    const cv::Vec3f normal = unit(crossOf(triangle));
    if (normal != cv::Vec3f()) thinning.offer(a + (b - a) * u + (c - a) * v, normal);
  }
  return thinning.taken();
}

}  // namespace robot_vision
