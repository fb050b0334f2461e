#pragma once

#include <cstddef>

#include "core/meshes/vertex_kernels.hpp"
#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

// A ray meets a triangle of the points a, b and c where it has the weights of its three sides: (b x c, c x a, a x b)
// times the ray are all above 0, or all below. Their sum, divided by a * (b x c), is 1 / w.

/// Triangles to draw, and the space that they may touch.
struct SeenTriangles
{
  const int* corners;  // three vertices each
  const int* drawn;    // the triangles to draw
  int count;           // of those
  double nearest;      // m: what is nearer is left out
  float margin;        // px by which u and v may be wrong
  float bend;          // 1/px: times the square of its size (px) that is how far a triangle bends out of its corners
};

/// What is drawn on: 1/w of what is nearest, and who that is. All rows have `columns` entries, a multiple of kLanes.
struct Raster
{
  static constexpr int kLanes = 8;

  int left;  // px: where it begins in what is drawn
  int top;
  int columns;
  int rows;
  float* inverse;           // 1/m, 0 where nothing is
  int* drawn;               // the index in SeenTriangles::drawn of what is nearest
  const float* xs;          // of each pixel's ray; without distortion one row for all: left, left + 1, ...
  const float* ys;          // nullptr without distortion
  std::ptrdiff_t ray_step;  // from a row of these to the next; 0 without distortion
};

struct RasterKernels
{
  void (*draw)(const SeenVertex* vertices, const SeenTriangles& triangles, const Raster& raster);
};

}  // namespace robot_vision
