#include "mesh_builder.hpp"

#include <cmath>

namespace robot_vision::samples
{
namespace
{

/// Adds triangles between two rows of vertices, each of `columns` + 1; the second row is to the left of who walks along
/// the first one, seen from outside. What has no area, at a pole, is left out.
void addStrip(Mesh& mesh, int first, int second, int columns)
{
  const auto place = [&](int vertex) { return mesh.vertices[static_cast<std::size_t>(vertex)]; };
  for (int i = 0; i < columns; ++i)
  {
    const int a = first + i, b = a + 1, c = second + i, d = c + 1;
    if (place(a) != place(b)) mesh.triangles.emplace_back(a, b, d);
    if (place(c) != place(d)) mesh.triangles.emplace_back(a, d, c);
  }
}

int addVertex(Mesh& mesh, const cv::Vec3d& at, const cv::Vec3d& normal, const cv::Vec3b& color)
{
  mesh.vertices.emplace_back(at);
  mesh.normals.emplace_back(cv::normalize(normal));
  mesh.colors.push_back(color);
  return static_cast<int>(mesh.vertices.size()) - 1;
}

/// The unit normal of a profile between two points: to the right.
cv::Vec2d across(const cv::Vec2d& from, const cv::Vec2d& to)
{
  return cv::normalize(cv::Vec2d(to[1] - from[1], from[0] - to[0]));
}

cv::Vec2d bandNormal(const std::vector<cv::Vec2d>& points, std::size_t i)
{
  const cv::Vec2d before = i > 0 ? across(points[i - 1], points[i]) : cv::Vec2d();
  const cv::Vec2d after = i + 1 < points.size() ? across(points[i], points[i + 1]) : cv::Vec2d();
  return before + after;
}

int addRing(Mesh& mesh, const cv::Vec2d& point, const cv::Vec2d& normal, int segments, const cv::Vec3b& color)
{
  const int first = static_cast<int>(mesh.vertices.size());
  for (int i = 0; i <= segments; ++i)
  {
    // The last column is at the very place of the first one.
    const double angle = 2.0 * CV_PI * (i % segments) / segments, x = std::cos(angle), y = std::sin(angle);
    addVertex(mesh, {point[0] * x, point[0] * y, point[1]}, {normal[0] * x, normal[0] * y, normal[1]}, color);
  }
  return first;
}

double twiceArea(const cv::Point2d& a, const cv::Point2d& b, const cv::Point2d& c)
{
  return (b - a).cross(c - a);
}

/// The triangles of a polygon without holes, counter-clockwise, by cutting its ears.
std::vector<cv::Vec3i> triangulate(const std::vector<cv::Point2d>& polygon)
{
  std::vector<int> rest(polygon.size());
  for (std::size_t i = 0; i < rest.size(); ++i)
    rest[i] = static_cast<int>(i);
  const auto at = [&](int i) { return polygon[static_cast<std::size_t>(i)]; };
  std::vector<cv::Vec3i> triangles;
  for (std::size_t i = 0; rest.size() > 3; i = (i + 1) % rest.size())
  {
    const int a = rest[i], b = rest[(i + 1) % rest.size()], c = rest[(i + 2) % rest.size()];
    bool ear = twiceArea(at(a), at(b), at(c)) > 0.0;
    for (const int p : rest)
      if (p != a && p != b && p != c)
        ear = ear && (twiceArea(at(a), at(b), at(p)) < 0.0 || twiceArea(at(b), at(c), at(p)) < 0.0 ||
                      twiceArea(at(c), at(a), at(p)) < 0.0);
    if (!ear) continue;
    triangles.emplace_back(a, b, c);
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>((i + 1) % rest.size()));
    i = i % rest.size();
  }
  triangles.emplace_back(rest[0], rest[1], rest[2]);
  return triangles;
}

}  // namespace

Mesh lathe(const std::vector<Band>& profile, int segments)
{
  Mesh mesh;
  for (const Band& band : profile)
  {
    int before = -1;
    for (std::size_t i = 0; i < band.points.size(); ++i)
    {
      const int ring = addRing(mesh, band.points[i], bandNormal(band.points, i), segments, band.color);
      if (before >= 0) addStrip(mesh, before, ring, segments);
      before = ring;
    }
  }
  return mesh;
}

Mesh tube(const std::vector<cv::Vec3d>& path, const cv::Vec2d& half_sizes, int segments, const cv::Vec3b& color)
{
  Mesh mesh;
  const cv::Vec3d side(0, 1, 0);
  const auto along = [&](std::size_t i)
  { return cv::normalize(path[std::min(i + 1, path.size() - 1)] - path[i > 0 ? i - 1 : 0]); };
  const auto addRow = [&](std::size_t i, const cv::Vec3d* flat)
  {
    const cv::Vec3d up = along(i).cross(side);
    const int first = static_cast<int>(mesh.vertices.size());
    for (int k = 0; k <= segments; ++k)
    {
      const double angle = 2.0 * CV_PI * (k % segments) / segments, x = std::cos(angle), y = std::sin(angle);
      const cv::Vec3d normal = up * (x * half_sizes[1]) - side * (y * half_sizes[0]);
      addVertex(mesh, path[i] + up * (x * half_sizes[0]) - side * (y * half_sizes[1]), flat != nullptr ? *flat : normal,
                color);
    }
    return first;
  };
  int before = -1;
  for (std::size_t i = 0; i < path.size(); ++i)
  {
    const int row = addRow(i, nullptr);
    if (before >= 0) addStrip(mesh, before, row, segments);
    before = row;
  }
  for (const std::size_t end : {std::size_t{0}, path.size() - 1})
  {
    const cv::Vec3d out = along(end) * (end == 0 ? -1.0 : 1.0);
    const int row = addRow(end, &out), middle = addVertex(mesh, path[end], out, color);
    for (int k = 0; k < segments; ++k)
      mesh.triangles.emplace_back(middle, row + k + (end == 0 ? 1 : 0), row + k + (end == 0 ? 0 : 1));
  }
  return mesh;
}

Mesh prism(const std::vector<cv::Point2d>& polygon, double low, double high, const cv::Vec3b& color)
{
  Mesh mesh;
  const std::vector<cv::Vec3i> faces = triangulate(polygon);
  for (const double z : {low, high})
  {
    const int first = static_cast<int>(mesh.vertices.size());
    for (const cv::Point2d& p : polygon)
      addVertex(mesh, {p.x, p.y, z}, {0, 0, z == low ? -1.0 : 1.0}, color);
    for (const cv::Vec3i& face : faces)
      mesh.triangles.emplace_back(z == low ? cv::Vec3i(face[0], face[2], face[1]) + cv::Vec3i::all(first)
                                           : face + cv::Vec3i::all(first));
  }
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const cv::Point2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const cv::Vec3d normal(b.y - a.y, a.x - b.x, 0);
    const int first = addVertex(mesh, {a.x, a.y, low}, normal, color);
    addVertex(mesh, {b.x, b.y, low}, normal, color);
    addVertex(mesh, {a.x, a.y, high}, normal, color);
    addVertex(mesh, {b.x, b.y, high}, normal, color);
    addStrip(mesh, first, first + 2, 1);
  }
  return mesh;
}

void add(Mesh& mesh, const Mesh& other)
{
  const auto first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
  mesh.colors.insert(mesh.colors.end(), other.colors.begin(), other.colors.end());
  for (const cv::Vec3i& triangle : other.triangles)
    mesh.triangles.push_back(triangle + cv::Vec3i::all(first));
}

}  // namespace robot_vision::samples
