#include "oriented_points.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{
namespace
{

constexpr float kMinCosine = 0.707F;  // between normals of points that are alike

/// The number of a cell; far ones may have the same.
std::uint64_t cellAt(std::int64_t x, std::int64_t y, std::int64_t z)
{
  constexpr std::uint64_t kPart = (1U << 21) - 1;
  return (static_cast<std::uint64_t>(x) & kPart) << 42 | (static_cast<std::uint64_t>(y) & kPart) << 21 |
         (static_cast<std::uint64_t>(z) & kPart);
}

}  // namespace

void PointThinning::begin(double distance)
{
  distance_ = distance;
  taken_.points.clear();
  taken_.normals.clear();
  cells_.clear();
}

void PointThinning::offer(const cv::Vec3f& point, const cv::Vec3f& normal)
{
  const auto cell = [&](int i)
  { return static_cast<std::int64_t>(std::floor(static_cast<double>(point[i]) / distance_)); };
  const std::int64_t x = cell(0), y = cell(1), z = cell(2);
  const auto square = static_cast<float>(distance_ * distance_);
  const auto isAlike = [&](std::uint32_t i)
  {
    const cv::Vec3f way = taken_.points[i] - point;
    return way.dot(way) < square && taken_.normals[i].dot(normal) > kMinCosine;
  };
  for (std::int64_t i = x - 1; i <= x + 1; ++i)
    for (std::int64_t j = y - 1; j <= y + 1; ++j)
      for (std::int64_t k = z - 1; k <= z + 1; ++k)
      {
        const auto found = cells_.find(cellAt(i, j, k));
        if (found != cells_.end() && std::any_of(found->second.begin(), found->second.end(), isAlike)) return;
      }
  cells_[cellAt(x, y, z)].push_back(static_cast<std::uint32_t>(taken_.size()));
  taken_.points.push_back(point);
  taken_.normals.push_back(normal);
}

}  // namespace robot_vision
