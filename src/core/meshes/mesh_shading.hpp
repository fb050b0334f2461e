#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/meshes/mesh_look.hpp"
#include "core/meshes/mesh_shades.hpp"
#include "core/meshes/raster_kernels.hpp"
#include "robot_vision/meshes/mesh_renderer.hpp"

namespace robot_vision
{

/// How a drawing is to be shaded.
struct Shading
{
  cv::Matx33f rotation;  // of the mesh in the camera's optical frame
  cv::Matx33f to_ray;    // from a ray of the raster to the same ray in the optical frame, (x, y, 1)
  cv::Vec2f step;        // from a pixel to the next, of rays of the raster
  cv::Vec3f to_light;    // of length 1; zeros: the light is at the camera
  cv::Rect place;        // of the raster in the view
  int id;                // for the image of ids
};

/// Memory that shade() works with.
struct ShadingScratch
{
  std::vector<float> normals;  // of the vertices, in the optical frame
  std::vector<int> known;      // of what is drawn: its entry in the lists below, if it is seen
  std::vector<int> triangles;  // that are seen
  std::vector<SurfaceShade> surfaces;
  std::vector<ColorShade> colors;
  std::vector<TextureShade> textures;
  std::vector<int> shades;        // of the pixels of a row
  std::vector<float> numbers[7];  // of the pixels of a row
};

/// Writes the pixels of the raster that triangles were drawn to into the images that the view has.
void shade(const MeshLook& look, const SeenVertex* vertices, const SeenTriangles& triangles, const Raster& raster,
           const Shading& shading, ShadingScratch& scratch, MeshView& view);

}  // namespace robot_vision
