#include <algorithm>
#include <cstring>
#include <numeric>

#include "mesh_parts.hpp"

namespace robot_vision
{
namespace
{

std::size_t at(int index)
{
  return static_cast<std::size_t>(index);
}

/// All that a mesh has of a vertex, as bytes to compare.
struct VertexKey
{
  float numbers[8];
  cv::Vec3b color;

  bool operator<(const VertexKey& other) const
  {
    const int order = std::memcmp(numbers, other.numbers, sizeof(numbers));
    return order != 0 ? order < 0 : std::memcmp(color.val, other.color.val, sizeof(color.val)) < 0;
  }
};

VertexKey keyOf(const Mesh& mesh, std::size_t i)
{
  const cv::Vec3f& place = mesh.vertices[i];
  const cv::Vec3f normal = mesh.normals.empty() ? cv::Vec3f() : mesh.normals[i];
  const cv::Vec2f uv = mesh.texture_coordinates.empty() ? cv::Vec2f() : mesh.texture_coordinates[i];
  VertexKey key = {{place[0], place[1], place[2], normal[0], normal[1], normal[2], uv[0], uv[1]},
                   mesh.colors.empty() ? cv::Vec3b() : mesh.colors[i]};
  for (float& number : key.numbers)
    if (number == 0.0F) number = 0.0F;  // -0 is the same
  return key;
}

bool hasArea(const Mesh& mesh, const cv::Vec3i& triangle)
{
  const cv::Vec3d a = mesh.vertices[at(triangle[0])], b = mesh.vertices[at(triangle[1])],
                  c = mesh.vertices[at(triangle[2])];
  const double longest = std::max({cv::norm(b - a), cv::norm(c - b), cv::norm(a - c)});
  // The places are of seven digits: what is flatter than that is no area.
  return cv::norm((b - a).cross(c - a)) > 1e-7 * longest * longest;
}

template <class T>
void pick(std::vector<T>& list, const std::vector<int>& wanted)
{
  if (list.empty()) return;
  std::vector<T> picked;
  picked.reserve(wanted.size());
  for (const int i : wanted)
    picked.push_back(list[at(i)]);
  list = std::move(picked);
}

/// For each vertex the first one that is the same.
std::vector<int> firstOfEach(const Mesh& mesh)
{
  std::vector<VertexKey> keys;
  keys.reserve(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    keys.push_back(keyOf(mesh, i));
  std::vector<int> order(keys.size()), first(keys.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return keys[at(a)] < keys[at(b)]; });
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    const bool same = i > 0 && !(keys[at(order[i - 1])] < keys[at(order[i])]);
    first[at(order[i])] = same ? first[at(order[i - 1])] : order[i];
  }
  return first;
}

}  // namespace

std::int64_t tidy(Mesh& mesh)
{
  std::vector<int> good;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (hasArea(mesh, mesh.triangles[i])) good.push_back(static_cast<int>(i));
  const auto dropped = static_cast<std::int64_t>(mesh.triangles.size() - good.size());
  pick(mesh.triangles, good);
  pick(mesh.triangle_textures, good);
  const std::vector<int> first = firstOfEach(mesh);
  std::vector<int> kept, places(mesh.vertices.size(), -1);
  for (cv::Vec3i& triangle : mesh.triangles)
    for (int& vertex : triangle.val)
    {
      int& place = places[at(first[at(vertex)])];
      if (place < 0)
      {
        place = static_cast<int>(kept.size());
        kept.push_back(first[at(vertex)]);
      }
      vertex = place;
    }
  pick(mesh.vertices, kept);
  pick(mesh.normals, kept);
  pick(mesh.colors, kept);
  pick(mesh.texture_coordinates, kept);
  return dropped;
}

void turnOutsideOut(Mesh& mesh, const std::vector<std::int8_t>& outsides)
{
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (outsides[i] < 0) std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
}

void turnNormals(Mesh& mesh)
{
  std::vector<double> agreements(mesh.normals.size());
  if (agreements.empty()) return;
  for (const cv::Vec3i& triangle : mesh.triangles)
  {
    const auto corner = [&](int k) { return cv::Vec3d(mesh.vertices[at(triangle[k])]); };
    const cv::Vec3d area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (const int vertex : triangle.val)
      agreements[at(vertex)] += area.dot(cv::Vec3d(mesh.normals[at(vertex)]));
  }
  for (std::size_t i = 0; i < agreements.size(); ++i)
    if (agreements[i] < 0.0) mesh.normals[i] *= -1.0F;
}

}  // namespace robot_vision
