#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/meshes/mesh_look.hpp"
#include "core/meshes/shade_kernels.hpp"
#include "core/meshes/vertex_kernels.hpp"

namespace robot_vision
{

/// Where the texture of a triangle is.
struct TextureShade
{
  const MeshTexture* texture;  // nullptr: it has none
  RayFunction inverse;         // 1/w
  RayFunction u, v;            // texture coordinates
};

/// Fills the texture's place of a triangle.
TextureShade textureShade(const MeshLook& look, const SeenVertex* vertices, int triangle);

}  // namespace robot_vision
