#pragma once

#include <cstdint>
#include <vector>

#include "robot_vision/meshes/mesh.hpp"

namespace robot_vision
{

/// How the triangles of a mesh hang together. Vertices at the same place count as one, whatever normals and texture
/// coordinates they have.
struct MeshSurface
{
  std::vector<int> places;  // of each vertex: the first vertex at its place

  /// Of each triangle: 1 if it is a part of a closed surface and its outside is where its vertices are
  /// counter-clockwise, -1 if its outside is the other side, 0 if both sides can be seen from outside.
  std::vector<std::int8_t> outsides;

  std::int64_t open_edges = 0;  // edges that do not have a triangle at both sides; 0: the mesh is closed
};

/// `mesh` must be valid.
MeshSurface meshSurface(const Mesh& mesh);

}  // namespace robot_vision
