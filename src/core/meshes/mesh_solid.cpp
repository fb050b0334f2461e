#include <algorithm>
#include <cmath>

#include "mesh_builder.hpp"

namespace robot_vision::samples
{
namespace
{

using Distance = std::function<double(const cv::Vec3d&)>;

/// The grid of points at which the distance is known. The method is that of naive surface nets: each cell that has
/// corners inside and outside has a vertex, and each edge between such corners a square of the four cells around it.
class Grid
{
public:
  Grid(const Distance& distance, const cv::Vec3d& low, const cv::Vec3d& high, double cell)
    : distance_(distance), low_(low - cv::Vec3d::all(1.5 * cell)), cell_(cell)
  {
    for (int axis = 0; axis < 3; ++axis)
      size_[axis] = static_cast<int>(std::ceil((high[axis] - low[axis]) / cell)) + 4;
    values_.resize(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1] * size_[2]));
    vertices_.assign(values_.size(), -1);
    forAll([&](const cv::Vec3i& at) { values_[index(at)] = distance(point(at)); });
  }

  Mesh mesh()
  {
    Mesh mesh;
    forAll([&](const cv::Vec3i& at) { addVertex(at, mesh); });
    forAll([&](const cv::Vec3i& at) { addSquares(at, mesh); });
    return mesh;
  }

  cv::Vec3d gradient(const cv::Vec3d& at) const
  {
    const double step = 1e-3 * cell_;
    cv::Vec3d result;
    for (int axis = 0; axis < 3; ++axis)
    {
      cv::Vec3d way;
      way[axis] = step;
      result[axis] = (distance_(at + way) - distance_(at - way)) / (2.0 * step);
    }
    return result;
  }

private:
  template <class Work>
  void forAll(const Work& work) const
  {
    for (int z = 0; z < size_[2]; ++z)
      for (int y = 0; y < size_[1]; ++y)
        for (int x = 0; x < size_[0]; ++x)
          work(cv::Vec3i(x, y, z));
  }

  std::size_t index(const cv::Vec3i& at) const
  {
    return static_cast<std::size_t>((at[2] * size_[1] + at[1]) * size_[0] + at[0]);
  }

  cv::Vec3d point(const cv::Vec3i& at) const { return low_ + cell_ * cv::Vec3d(at); }
  bool inside(const cv::Vec3i& at) const { return values_[index(at)] < 0.0; }

  /// Puts a vertex into a cell: the middle of where its edges meet the surface, and from there onto the surface.
  void addVertex(const cv::Vec3i& cell, Mesh& mesh)
  {
    if (cell[0] + 1 >= size_[0] || cell[1] + 1 >= size_[1] || cell[2] + 1 >= size_[2]) return;
    cv::Vec3d sum;
    int crossings = 0;
    for (int corner = 0; corner < 8; ++corner)
      for (int axis = 0; axis < 3; ++axis)
      {
        if ((corner >> axis & 1) != 0) continue;
        const cv::Vec3i from = cell + cv::Vec3i(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
        cv::Vec3i to = from;
        ++to[axis];
        const double a = values_[index(from)], b = values_[index(to)];
        if ((a < 0.0) == (b < 0.0)) continue;
        sum += point(from) + (point(to) - point(from)) * (a / (a - b));
        ++crossings;
      }
    if (crossings == 0) return;
    cv::Vec3d at = sum / crossings;
    for (int step = 0; step < 3; ++step)
    {
      const cv::Vec3d slope = gradient(at);
      const cv::Vec3d way = slope * (-distance_(at) / std::max(slope.dot(slope), 0.25));
      at += way * std::min(1.0, 0.5 * cell_ / std::max(cv::norm(way), 1e-12));
    }
    vertices_[index(cell)] = static_cast<int>(mesh.vertices.size());
    mesh.vertices.emplace_back(at);
    mesh.normals.emplace_back(cv::normalize(gradient(at)));
  }

  void addSquares(const cv::Vec3i& at, Mesh& mesh) const
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      cv::Vec3i next = at, right, up;
      ++next[axis];
      if (next[axis] >= size_[axis] || inside(at) == inside(next)) continue;
      right[(axis + 1) % 3] = 1;
      up[(axis + 2) % 3] = 1;
      int corners[4] = {vertexOf(at - right - up), vertexOf(at - up), vertexOf(at), vertexOf(at - right)};
      if (!inside(at)) std::swap(corners[1], corners[3]);
      mesh.triangles.emplace_back(corners[0], corners[1], corners[2]);
      mesh.triangles.emplace_back(corners[0], corners[2], corners[3]);
    }
  }

  int vertexOf(const cv::Vec3i& cell) const { return vertices_[index(cell)]; }

  const Distance& distance_;
  cv::Vec3d low_;
  double cell_;
  cv::Vec3i size_;
  std::vector<double> values_;
  std::vector<int> vertices_;  // of the cell whose first corner is this point
};

}  // namespace

Mesh solid(const Distance& distance, const std::function<cv::Vec3b(const cv::Vec3d&)>& color, const cv::Vec3d& low,
           const cv::Vec3d& high, double cell)
{
  Mesh mesh = Grid(distance, low, high, cell).mesh();
  for (const cv::Vec3f& vertex : mesh.vertices)
    mesh.colors.push_back(color(vertex));
  return mesh;
}

}  // namespace robot_vision::samples
