#include "robot_vision/meshes/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "robot_vision/common/range.hpp"
#include "used_vertices.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxCoordinate = 1000.0;  // m, and of texture coordinates
constexpr std::size_t kMaxVertices = 1U << 30U;

bool isSmall(float number)
{
  return std::abs(number) <= kMaxCoordinate;
}

/// Throws unless there is one entry for each vertex or triangle, or none.
void requireOneEach(const std::string& name, std::size_t entries, std::size_t count, const std::string& of)
{
  require(entries == 0 || entries == count, "number of " + name, static_cast<double>(entries),
          std::to_string(count) + ", as there are " + of + ", or 0");
}

template <class Vector>
void requireFinite(const std::string& name, const std::vector<Vector>& vectors)
{
  const auto bad =
      std::find_if_not(vectors.begin(), vectors.end(),
                       [](const Vector& v) { return std::all_of(v.val, v.val + Vector::channels, isSmall); });
  if (bad == vectors.end()) return;
  const float* number = std::find_if_not(bad->val, bad->val + Vector::channels, isSmall);
  require(false, name + " " + std::to_string(bad - vectors.begin()), *number, "finite and at most 1000");
}

void validateTextures(const Mesh& mesh)
{
  for (const cv::Mat& texture : mesh.textures)
    require(!texture.empty() && texture.type() == CV_8UC3, "a texture", texture.empty() ? "empty" : "of another type",
            "an 8-bit BGR image");
  requireOneEach("textures of triangles", mesh.triangle_textures.size(), mesh.triangles.size(), "triangles");
  const auto count = static_cast<int>(mesh.textures.size());
  for (const int texture : mesh.triangle_textures)
    if (texture < -1 || texture >= count) requireRange("the texture of a triangle", texture, -1, count - 1);
  const bool textured = std::any_of(mesh.triangle_textures.begin(), mesh.triangle_textures.end(),
                                    [](int texture) { return texture >= 0; });
  require(!textured || !mesh.texture_coordinates.empty(), "number of texture coordinates", 0,
          "that of the vertices where triangles have textures");
}

const cv::Vec3d& farthest(const std::vector<cv::Vec3d>& points, const cv::Vec3d& from)
{
  const cv::Vec3d* best = &points.front();
  double most = -1.0;
  for (const cv::Vec3d& point : points)
  {
    const cv::Vec3d way = point - from;
    const double squared = way.dot(way);
    if (squared > most) best = &point, most = squared;
  }
  return *best;
}

/// The points that are farthest along some directions all around, of which one pair is the ends of the diameter, or
/// near them.
std::vector<cv::Vec3d> extremePoints(const std::vector<cv::Vec3d>& points)
{
  const int directions = 128;
  std::vector<cv::Vec3d> extremes;
  for (int i = 0; i < directions; ++i)  // a spiral of Fibonacci on the upper half of the sphere
  {
    const double z = (i + 0.5) / directions, radius = std::sqrt(1.0 - z * z),
                 angle = i * CV_PI * (3.0 - std::sqrt(5.0));
    const cv::Vec3d direction(radius * std::cos(angle), radius * std::sin(angle), z);
    const cv::Vec3d *first = &points.front(), *last = first;
    double low = first->dot(direction), high = low;
    for (const cv::Vec3d& point : points)
    {
      const double along = point.dot(direction);
      if (along < low) first = &point, low = along;
      if (along > high) last = &point, high = along;
    }
    extremes.push_back(*first);
    extremes.push_back(*last);
  }
  return extremes;
}

double diameterOf(const std::vector<cv::Vec3d>& points)
{
  const std::vector<cv::Vec3d> extremes = extremePoints(points);
  cv::Vec3d a = points.front(), b = a;
  for (const cv::Vec3d& one : extremes)
  {
    const cv::Vec3d& other = farthest(extremes, one);
    if (cv::norm(one - other) > cv::norm(a - b)) a = one, b = other;
  }
  for (;;)  // each step is farther than the one before, so this ends
  {
    const cv::Vec3d from_b = farthest(points, b), from_a = farthest(points, from_b);
    if (cv::norm(from_b - from_a) <= cv::norm(a - b)) return cv::norm(a - b);
    a = from_a, b = from_b;
  }
}

}  // namespace

void validate(const Mesh& mesh)
{
  const std::size_t vertices = mesh.vertices.size();
  require(vertices > 0 && vertices < kMaxVertices, "number of vertices", static_cast<double>(vertices),
          "from 1 to 2^30 - 1");
  require(!mesh.triangles.empty() && mesh.triangles.size() < kMaxVertices, "number of triangles",
          static_cast<double>(mesh.triangles.size()), "from 1 to 2^30 - 1");
  for (const cv::Vec3i& triangle : mesh.triangles)
    for (const int vertex : triangle.val)
      if (vertex < 0 || static_cast<std::size_t>(vertex) >= vertices)
        requireRange("a vertex of a triangle", vertex, 0, static_cast<double>(vertices) - 1);
  requireOneEach("normals", mesh.normals.size(), vertices, "vertices");
  requireOneEach("colors", mesh.colors.size(), vertices, "vertices");
  requireOneEach("texture coordinates", mesh.texture_coordinates.size(), vertices, "vertices");
  requireFinite("vertex", mesh.vertices);
  requireFinite("normal", mesh.normals);
  requireFinite("texture coordinate", mesh.texture_coordinates);
  validateTextures(mesh);
}

MeshExtent meshExtent(const Mesh& mesh)
{
  validate(mesh);
  const std::vector<cv::Vec3d> vertices = usedVertices(mesh);
  cv::Vec3d low = vertices.front(), high = low;
  for (const cv::Vec3d& vertex : vertices)
    for (int axis = 0; axis < 3; ++axis)
    {
      low[axis] = std::min(low[axis], vertex[axis]);
      high[axis] = std::max(high[axis], vertex[axis]);
    }
  MeshExtent extent;
  extent.center = (low + high) / 2.0;
  extent.size = high - low;
  extent.diameter = diameterOf(vertices);
  extent.radius = cv::norm(farthest(vertices, extent.center) - extent.center);
  return extent;
}

}  // namespace robot_vision
