#include "mesh_look.hpp"

namespace robot_vision
{

MeshLook::MeshLook(const Mesh& mesh, const std::vector<std::int8_t>& sides)
  : triangles(mesh.triangles),
    outsides(sides),
    texture_coordinates(mesh.texture_coordinates),
    textures(mesh.textures.begin(), mesh.textures.end()),
    triangle_textures(mesh.triangle_textures),
    color(mesh.color)
{
  for (const cv::Vec3b& vertex : mesh.colors)
    colors.insert(colors.end(), vertex.val, vertex.val + 3);
  for (const cv::Vec3f& normal : mesh.normals)
    for (int axis = 0; axis < 3; ++axis)
      normals[axis].push_back(normal[axis]);
  for (const cv::Vec3i& triangle : triangles)
  {
    const auto corner = [&](int k) { return cv::Vec3d(mesh.vertices[static_cast<std::size_t>(triangle[k])]); };
    const cv::Vec3d across = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    const double length = cv::norm(across);
    flat_normals.emplace_back(length > 0.0 ? across / length : cv::Vec3d());
  }
}

}  // namespace robot_vision
