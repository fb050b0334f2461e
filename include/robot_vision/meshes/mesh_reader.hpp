#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robot_vision/meshes/mesh.hpp"

namespace robot_vision
{

/// A mesh of a file, in m, and what there is to say of it.
struct LoadedMesh
{
  Mesh mesh;
  std::string unit;                   // of the file: m, cm, mm or inch
  std::string unit_reason;            // a sentence that says why it is taken for this one
  bool closed = false;                // whether each edge has triangles on both sides
  std::int64_t open_edges = 0;        // that have not
  std::int64_t dropped = 0;           // triangles without an area, which were left out
  std::vector<std::string> warnings;  // sentences: textures that are missing, what is not closed, ...
};

/// Reads a mesh: stl, obj, dae, ply, gltf, glb, and what else assimp knows. A process of its own does it, which may
/// take 90 s, 20 of them computing, and 2 GB, and hand over 0.5 GB, so that files by hostile hands can harm nothing.
/// All that the file has becomes one mesh, moved as its scene says; points and lines are left out, vertices that are
/// the same are merged. Where the file has no normals, edges of more than 40 degrees are sharp. Closed surfaces whose
/// inside was out are turned, and so are normals that do not point to the outside of their triangles.
///
/// `unit` is that of the file: m, cm, mm or inch; if it is empty, it is what the file says, or what makes a thing that
/// one can handle. `scale`, which is positive, is what the numbers of the file are multiplied by besides.
///
/// Throws std::invalid_argument naming the path if the unit is another one, the scale is not positive, or the file is
/// no mesh that can be used: no triangles, more than 2 million, numbers that are not finite, a thing of less than 5 mm
/// or more than 3 m, and std::runtime_error if it cannot be read: it is not there, damaged, or takes too long or too
/// much memory.
LoadedMesh readMesh(const std::string& path, const std::string& unit = "", double scale = 1.0);

}  // namespace robot_vision
