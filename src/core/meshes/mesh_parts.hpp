#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robot_vision/meshes/mesh.hpp"

// The steps of readMesh().
namespace robot_vision
{

/// What the program read_mesh writes, as mesh_stream.hpp describes it: a mesh in the unit of its file, some of whose
/// normals may be 0, 0, 0.
struct StreamedMesh
{
  Mesh mesh;
  std::vector<std::string> warnings;
  bool is_metric = false;
};

/// Throws std::runtime_error for anything else.
StreamedMesh parseMeshStream(const std::string& bytes);

/// Leaves out triangles without an area, and returns how many. Vertices that are the same become one, those that no
/// triangle has go.
std::int64_t tidy(Mesh& mesh);

/// Turns the triangles of closed surfaces whose inside is out. `outsides` is that of the mesh's MeshSurface.
void turnOutsideOut(Mesh& mesh, const std::vector<std::int8_t>& outsides);

/// Turns the normals of vertices to the side from which their triangles are counter-clockwise.
void turnNormals(Mesh& mesh);

/// Gives normals to the vertices that have none (0, 0, 0): the mean of those triangles around them whose normals are
/// less than `crease` (deg) from each other. A vertex that so gets several becomes several. `places` are those of the
/// mesh's MeshSurface.
void addNormals(Mesh& mesh, const std::vector<int>& places, double crease);

/// The unit of a mesh of this size (m if its numbers are m), and the sentence that says why.
struct MeshUnit
{
  std::string name;
  double metres;  // of one
  std::string reason;
};

/// `named` is what the user says, or empty; `scale` is what the numbers are multiplied by besides. Throws
/// std::invalid_argument for an unknown unit, another scale than a positive one, and if the size in m is not that of a
/// thing to be handled.
MeshUnit meshUnit(const std::string& named, bool is_metric, const cv::Vec3d& size, double scale);

}  // namespace robot_vision
