#include "surface_nets.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>

#include "core/common/joined_sets.hpp"

namespace robot_vision
{
namespace
{

class Nets
{
public:
  Nets(const std::vector<float>& values, const cv::Vec3i& size) : values_(values), size_(size)
  {
    cells_.assign(values.size(), -1);
  }

  NetSurface surface()
  {
    forEach([this](const cv::Vec3i& at) { addVertex(at); });
    forEach([this](const cv::Vec3i& at) { addFaces(at); });
    return std::move(surface_);
  }

private:
  template <class Visit>
  void forEach(const Visit& visit) const
  {
    for (int z = 0; z + 1 < size_[2]; ++z)
      for (int y = 0; y + 1 < size_[1]; ++y)
        for (int x = 0; x + 1 < size_[0]; ++x)
          visit({x, y, z});
  }

  std::size_t indexOf(const cv::Vec3i& at) const
  {
    return (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(at[1])) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(at[0]);
  }

  float valueAt(const cv::Vec3i& at) const { return values_[indexOf(at)]; }

  static cv::Vec3i cornerOf(const cv::Vec3i& cell, int corner)
  {
    return {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2 & 1)};
  }

  /// Puts a vertex into the middle of the points where the surface crosses the edges of a cell.
  void addVertex(const cv::Vec3i& cell)
  {
    cv::Vec3f sum;
    int crossings = 0;
    for (int from = 0; from < 8; ++from)
      for (int axis = 0; axis < 3; ++axis)
      {
        if (from >> axis & 1) continue;
        const cv::Vec3i a = cornerOf(cell, from), b = cornerOf(cell, from | 1 << axis);
        const float first = valueAt(a), second = valueAt(b);
        if ((first < 0.0F) == (second < 0.0F)) continue;
        cv::Vec3f point = a;
        point[axis] += first / (first - second);
        sum += point;
        ++crossings;
      }
    if (crossings == 0) return;
    cells_[indexOf(cell)] = static_cast<int>(surface_.vertices.size());
    surface_.vertices.push_back(sum * (1.0F / static_cast<float>(crossings)));
  }

  /// Joins the four cells around each edge that begins at a point, if the surface crosses it.
  void addFaces(const cv::Vec3i& at)
  {
    const bool is_inside = valueAt(at) < 0.0F;
    for (int axis = 0; axis < 3; ++axis)
    {
      cv::Vec3i end = at;
      ++end[axis];
      if (is_inside == (valueAt(end) < 0.0F)) continue;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      if (at[u] == 0 || at[v] == 0) continue;
      cv::Vec3i corners[4] = {at, at, at, at};
      --corners[1][u];
      --corners[2][u];
      --corners[2][v];
      --corners[3][v];
      int quad[4];
      for (int i = 0; i < 4; ++i)
        quad[i] = cells_[indexOf(corners[i])];
      if (!is_inside) std::swap(quad[1], quad[3]);
      surface_.triangles.emplace_back(quad[0], quad[1], quad[2]);
      surface_.triangles.emplace_back(quad[0], quad[2], quad[3]);
    }
  }

  const std::vector<float>& values_;
  cv::Vec3i size_;
  std::vector<int> cells_;  // vertices
  NetSurface surface_;
};

}  // namespace

NetSurface surfaceNets(const std::vector<float>& values, const cv::Vec3i& size)
{
  return Nets(values, size).surface();
}

void keepLargePieces(double share, NetSurface& surface)
{
  std::vector<int> parents(surface.vertices.size());
  std::iota(parents.begin(), parents.end(), 0);
  for (const cv::Vec3i& triangle : surface.triangles)
    for (int i = 1; i < 3; ++i)
      parents[static_cast<std::size_t>(rootOf(parents, triangle[i]))] = rootOf(parents, triangle[0]);
  std::map<int, std::size_t> sizes;
  std::size_t largest = 0;
  for (const cv::Vec3i& triangle : surface.triangles)
    largest = std::max(largest, ++sizes[rootOf(parents, triangle[0])]);
  NetSurface kept;
  std::vector<int> numbers(surface.vertices.size(), -1);
  for (cv::Vec3i triangle : surface.triangles)
  {
    if (static_cast<double>(sizes[rootOf(parents, triangle[0])]) < share * static_cast<double>(largest)) continue;
    for (int i = 0; i < 3; ++i)
    {
      int& number = numbers[static_cast<std::size_t>(triangle[i])];
      if (number < 0)
      {
        number = static_cast<int>(kept.vertices.size());
        kept.vertices.push_back(surface.vertices[static_cast<std::size_t>(triangle[i])]);
      }
      triangle[i] = number;
    }
    kept.triangles.push_back(triangle);
  }
  surface = std::move(kept);
}

}  // namespace robot_vision
