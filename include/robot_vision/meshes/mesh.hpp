#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// The surface of a thing, of triangles. All lists of vertices have one entry for each vertex, in the same order.
struct Mesh
{
  std::vector<cv::Vec3f> vertices;             // m, in the mesh's own frame
  std::vector<cv::Vec3i> triangles;            // vertices, counter-clockwise for who sees the outside
  std::vector<cv::Vec3f> normals;              // of the vertices, of length 1; empty: each triangle is flat
  std::vector<cv::Vec3b> colors;               // BGR of the vertices; empty: all have `color`
  std::vector<cv::Vec2f> texture_coordinates;  // of the vertices, 0 to 1 right and down from the top left corner of the
                                               // texture, which repeats beyond; empty: there is no texture
  std::vector<cv::Mat> textures;               // CV_8UC3 BGR
  std::vector<int> triangle_textures;          // the texture of each triangle, -1: none; empty: none has one
  cv::Vec3b color{160, 160, 160};              // BGR of what has neither a texture nor colors
};

/// Throws std::invalid_argument naming the first thing that no mesh can have: no vertices or triangles, lists of
/// different lengths, numbers that are not finite or beyond 1000, indices of what is not there, textures that are empty
/// or of another type.
void validate(const Mesh& mesh);

/// Where the vertices of a mesh are.
struct MeshExtent
{
  cv::Vec3d center;       // m, the middle of the smallest box along the axes around them
  cv::Vec3d size;         // m, of that box
  double diameter = 0.0;  // m, the largest distance of two vertices
  double radius = 0.0;    // m, the largest distance of a vertex from the center
};

/// The extent of the vertices that triangles use. The diameter is searched for, and is exact for all but shapes that
/// are nearly round, where it can be 0.1 % too small. Throws as validate() does.
MeshExtent meshExtent(const Mesh& mesh);

}  // namespace robot_vision
