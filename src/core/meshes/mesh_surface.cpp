#include "mesh_surface.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "core/common/joined_sets.hpp"

namespace robot_vision
{
namespace
{

/// The side of a triangle between two places, low < high.
struct Side
{
  int low;
  int high;
  bool forward;  // whether the triangle goes from the low one to the high one
  int triangle;

  auto key() const { return std::make_tuple(low, high); }
};

std::vector<int> findPlaces(const std::vector<cv::Vec3f>& vertices)
{
  std::vector<int> order(vertices.size()), places(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i)
  {
    const cv::Vec3f& v = vertices[static_cast<std::size_t>(i)];
    return std::make_tuple(v[0], v[1], v[2]);
  };
  std::sort(order.begin(), order.end(),
            [&](int a, int b)
            { return std::tuple_cat(key(a), std::make_tuple(a)) < std::tuple_cat(key(b), std::make_tuple(b)); });
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    places[static_cast<std::size_t>(order[i])] = same ? places[static_cast<std::size_t>(order[i - 1])] : order[i];
  }
  return places;
}

cv::Vec3i placesOf(const cv::Vec3i& triangle, const std::vector<int>& places)
{
  const auto place = [&](int vertex) { return places[static_cast<std::size_t>(vertex)]; };
  return {place(triangle[0]), place(triangle[1]), place(triangle[2])};
}

bool isDegenerate(const cv::Vec3i& p)
{
  return p[0] == p[1] || p[1] == p[2] || p[2] == p[0];
}

std::vector<Side> findSides(const Mesh& mesh, const std::vector<int>& places)
{
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
  {
    const cv::Vec3i p = placesOf(mesh.triangles[i], places);
    if (isDegenerate(p)) continue;
    for (int k = 0; k < 3; ++k)
    {
      const int from = p[k], to = p[(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), from < to, static_cast<int>(i)});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b)
            {
              return std::tuple_cat(a.key(), std::make_tuple(a.triangle)) <
                     std::tuple_cat(b.key(), std::make_tuple(b.triangle));
            });
  return sides;
}

/// Six times the volume of the pyramid from the origin to a triangle.
double volumeBelow(const Mesh& mesh, const cv::Vec3i& triangle)
{
  const auto corner = [&](int k) { return cv::Vec3d(mesh.vertices[static_cast<std::size_t>(triangle[k])]); };
  return corner(0).dot(corner(1).cross(corner(2)));
}

}  // namespace

MeshSurface meshSurface(const Mesh& mesh)
{
  MeshSurface surface;
  surface.places = findPlaces(mesh.vertices);
  const std::vector<Side> sides = findSides(mesh, surface.places);
  std::vector<int> parts(mesh.triangles.size());  // parents of triangles
  std::iota(parts.begin(), parts.end(), 0);
  const auto part_of = [&parts](int triangle) { return static_cast<std::size_t>(rootOf(parts, triangle)); };
  std::vector<int> seen_from_inside;  // a triangle of each part that has another beside it only on one side, or turned
  for (auto begin = sides.begin(); begin != sides.end();)
  {
    const auto end = std::find_if(begin, sides.end(), [&](const Side& side) { return side.key() != begin->key(); });
    const auto forward = std::count_if(begin, end, [](const Side& side) { return side.forward; });
    for (auto side = begin; side != end; ++side)
      parts[part_of(side->triangle)] = rootOf(parts, begin->triangle);
    if ((end - begin) % 2 != 0) ++surface.open_edges;
    if (2 * forward != end - begin) seen_from_inside.push_back(begin->triangle);
    begin = end;
  }
  std::vector<double> volumes(mesh.triangles.size());
  for (std::size_t i = 0; i < volumes.size(); ++i)
    volumes[part_of(static_cast<int>(i))] += volumeBelow(mesh, mesh.triangles[i]);
  for (const int triangle : seen_from_inside)
    volumes[part_of(triangle)] = 0.0;
  for (std::size_t i = 0; i < volumes.size(); ++i)
  {
    const double volume = volumes[part_of(static_cast<int>(i))];
    surface.outsides.push_back(static_cast<std::int8_t>(volume > 0.0 ? 1 : volume < 0.0 ? -1 : 0));
  }
  return surface;
}

}  // namespace robot_vision
