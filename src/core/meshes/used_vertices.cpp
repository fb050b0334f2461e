#include "used_vertices.hpp"

namespace robot_vision
{

std::vector<cv::Vec3d> usedVertices(const Mesh& mesh)
{
  std::vector<bool> used(mesh.vertices.size());
  for (const cv::Vec3i& triangle : mesh.triangles)
    for (const int vertex : triangle.val)
      used[static_cast<std::size_t>(vertex)] = true;
  std::vector<cv::Vec3d> vertices;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) vertices.emplace_back(mesh.vertices[i]);
  return vertices;
}

}  // namespace robot_vision
