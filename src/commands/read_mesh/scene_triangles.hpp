#pragma once

#include <assimp/scene.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/meshes/mesh_stream.hpp"

namespace robot_vision
{

/// The triangles of all that a file has, in one list, as MeshStreamHeader describes them.
struct SceneTriangles
{
  std::vector<cv::Vec3f> vertices, normals;
  std::vector<cv::Vec2f> texture_coordinates;
  std::vector<cv::Vec3b> colors;
  std::vector<cv::Vec3i> triangles;
  std::vector<std::int32_t> triangle_textures;
  std::vector<cv::Mat> textures;
  std::string warnings;
  bool is_metric = false;
};

/// Throws std::invalid_argument if there are too many triangles.
SceneTriangles trianglesOf(const aiScene& scene, const std::string& path);

}  // namespace robot_vision
