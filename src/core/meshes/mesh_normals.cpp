#include <algorithm>
#include <cmath>

#include "mesh_parts.hpp"

namespace robot_vision
{
namespace
{

std::size_t at(int index)
{
  return static_cast<std::size_t>(index);
}

/// A corner of a triangle at a place.
struct Corner
{
  int place;
  int triangle;
  int which;  // 0 to 2
};

/// Makes the normals of the corners at each place.
class NormalMaker
{
public:
  NormalMaker(Mesh& mesh, const std::vector<int>& places, double crease)
    : mesh_(mesh), places_(places), min_cosine_(std::cos(crease * CV_PI / 180.0))
  {
    for (const cv::Vec3i& triangle : mesh.triangles)
    {
      const auto corner = [&](int k) { return cv::Vec3d(mesh.vertices[at(triangle[k])]); };
      areas_.push_back((corner(1) - corner(0)).cross(corner(2) - corner(0)));
    }
  }

  void run()
  {
    const std::vector<Corner> corners = sortedCorners();
    for (auto begin = corners.begin(); begin != corners.end();)
    {
      const auto end = std::find_if(begin, corners.end(), [&](const Corner& c) { return c.place != begin->place; });
      const std::vector<Corner> here(begin, end);
      for (const Corner& corner : here)
        set(corner, meanAround(corner, here));
      begin = end;
    }
  }

private:
  /// The corners of vertices without normals, by their places.
  std::vector<Corner> sortedCorners() const
  {
    std::vector<Corner> corners;
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k)
      {
        const int vertex = mesh_.triangles[i][k];
        if (mesh_.normals[at(vertex)] == cv::Vec3f()) corners.push_back({places_[at(vertex)], static_cast<int>(i), k});
      }
    std::stable_sort(corners.begin(), corners.end(),
                     [](const Corner& a, const Corner& b) { return a.place < b.place; });
    return corners;
  }

  double angleAt(const Corner& corner) const
  {
    const cv::Vec3i& triangle = mesh_.triangles[at(corner.triangle)];
    const cv::Vec3d here = mesh_.vertices[at(triangle[corner.which])];
    const cv::Vec3d a = cv::Vec3d(mesh_.vertices[at(triangle[(corner.which + 1) % 3])]) - here;
    const cv::Vec3d b = cv::Vec3d(mesh_.vertices[at(triangle[(corner.which + 2) % 3])]) - here;
    return std::atan2(cv::norm(a.cross(b)), a.dot(b));
  }

  /// Each triangle counts by its angle here, so that how a face is cut into triangles makes no difference. Where more
  /// triangles meet than on any smooth surface, each has its own: to compare all of them could take forever.
  cv::Vec3f meanAround(const Corner& corner, const std::vector<Corner>& here) const
  {
    const std::size_t most = 200;
    const cv::Vec3d own = cv::normalize(areas_[at(corner.triangle)]);
    if (here.size() > most) return own;
    cv::Vec3d sum;
    for (const Corner& other : here)
    {
      const cv::Vec3d normal = cv::normalize(areas_[at(other.triangle)]);
      if (normal.dot(own) >= min_cosine_) sum += normal * angleAt(other);
    }
    return cv::normalize(sum);
  }

  /// Gives a corner its normal, by a vertex of its own unless the one that it has fits.
  void set(const Corner& corner, const cv::Vec3f& normal)
  {
    int& vertex = mesh_.triangles[at(corner.triangle)][corner.which];
    const cv::Vec3f& present = mesh_.normals[at(vertex)];
    if (present != cv::Vec3f() && present != normal)
    {
      mesh_.vertices.push_back(cv::Vec3f(mesh_.vertices[at(vertex)]));
      if (!mesh_.colors.empty()) mesh_.colors.push_back(cv::Vec3b(mesh_.colors[at(vertex)]));
      if (!mesh_.texture_coordinates.empty())
        mesh_.texture_coordinates.push_back(cv::Vec2f(mesh_.texture_coordinates[at(vertex)]));
      mesh_.normals.emplace_back();
      vertex = static_cast<int>(mesh_.vertices.size()) - 1;
    }
    mesh_.normals[at(vertex)] = normal;
  }

  Mesh& mesh_;
  const std::vector<int>& places_;
  double min_cosine_;
  std::vector<cv::Vec3d> areas_;
};

}  // namespace

void addNormals(Mesh& mesh, const std::vector<int>& places, double crease)
{
  mesh.normals.resize(mesh.vertices.size());
  NormalMaker(mesh, places, crease).run();
}

}  // namespace robot_vision
