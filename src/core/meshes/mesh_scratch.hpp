#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/meshes/mesh_shading.hpp"
#include "robot_vision/meshes/mesh_renderer.hpp"

namespace robot_vision
{

/// Memory that a renderer works with.
struct MeshView::Scratch
{
  std::vector<SeenVertex> seen;
  std::vector<int> facing;     // triangles that face the camera
  std::vector<float> columns;  // of a camera without distortion, as Raster has them
  std::vector<float> inverse;  // 1/w of what is nearest
  std::vector<int> drawn;      // who that is; -1: none of the mesh
  ShadingScratch shading;
};

}  // namespace robot_vision
