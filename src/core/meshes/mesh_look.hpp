#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/meshes/mesh_textures.hpp"
#include "robot_vision/meshes/mesh.hpp"

namespace robot_vision
{

/// What a mesh looks like.
struct MeshLook
{
  /// `outsides` is that of the mesh's MeshSurface.
  MeshLook(const Mesh& mesh, const std::vector<std::int8_t>& outsides);

  std::vector<cv::Vec3i> triangles;
  std::vector<std::int8_t> outsides;    // of the triangles, as MeshSurface has them
  std::vector<cv::Vec3f> flat_normals;  // of the triangles, 0 of those without an area
  std::vector<float> normals[3];        // of the vertices, x, y and z in rows; empty: there are none
  std::vector<float> colors;            // BGR of the vertices, 0 to 255, one after the other; empty: all have `color`
  std::vector<cv::Vec2f> texture_coordinates;  // these are as in Mesh
  std::vector<MeshTexture> textures;
  std::vector<int> triangle_textures;
  cv::Vec3b color;
};

}  // namespace robot_vision
