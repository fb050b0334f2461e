#pragma once

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// A vertex as a camera sees it: at the point (x, y, w), which is w times the ray (x / w, y / w, 1) of a pixel. Without
/// distortion a ray is the position of a pixel in what is drawn, and with it the ray of the optical frame.
struct SeenVertex
{
  double x;
  double y;
  double w;  // m
  float u;   // px: where it is in what is drawn, which has a meaning only where w is not too near
  float v;
};

/// Bounds of all vertices.
struct SeenBounds
{
  double min_w;  // m
  double min_u;  // px
  double max_u;
  double min_v;
  double max_v;
};

struct VertexKernels
{
  /// Multiplies points, given as three rows of coordinates, with a 3x4 matrix. u is x / w, and v is y / w; their bounds
  /// have a meaning only if w is above 0.
  SeenBounds (*transform)(const float* const* points, int count, const double* matrix, SeenVertex* seen);

  /// Multiplies vectors, given as three rows of coordinates, with a 3x3 matrix, and writes three numbers for each.
  void (*rotate)(const float* const* vectors, int count, const float* matrix, float* rotated);

  /// Writes which of `count` planes, given as rows of a, b, c and d, have a x + b y + c z + d > 0 at the point; returns
  /// how many. There must be room for one more.
  int (*facing)(const float* const* planes, int count, const float* point, int* found);
};

}  // namespace robot_vision
