#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// Points of a view with their normals, `count` numbers each.
struct FitPoints
{
  const float *x, *y, *z;  // m, from the anchor
  const float *nx, *ny, *nz;
};

struct FitPose
{
  float rotation[9];  // row by row, from the view to the camera's optical frame
  float anchor[3];    // m
};

struct FitCamera
{
  float fx, fy, cx, cy;  // px
  float width, height;   // px
};

/// Where a camera sees the points.
struct SeenPoints
{
  float *x, *y, *z;  // m, in its optical frame
  float *nx, *ny, *nz;
  float* inverse;       // 1 / z
  std::int32_t *u, *v;  // px; u is -1 if it is not in the image
};

struct FitKernels
{
  void (*project)(const FitPoints& points, int count, const FitPose& pose, const FitCamera& camera,
                  const SeenPoints& seen);
};

}  // namespace robot_vision
