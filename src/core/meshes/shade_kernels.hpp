#pragma once

#include <cstdint>

#include "core/meshes/vertex_kernels.hpp"
#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// A linear function of the ray of a pixel, (x, y, 1). Numbers that are linear on a triangle are such functions,
/// divided by that of 1/w.
struct RayFunction
{
  float x;
  float y;
  float one;
};

/// How the surface of a triangle lies.
struct SurfaceShade
{
  RayFunction normal[3];  // a smooth one in the optical frame, of some length, towards the camera's side
  float flat[3];          // that of the triangle, of length 1
};

/// Triangles whose shades are to be made.
struct ShadedTriangles
{
  const SeenVertex* vertices;
  const int* corners;    // three vertices of each triangle there is
  const int* triangles;  // which ones
  int count;
};

/// The colors that its vertices have, BGR.
struct ColorShade
{
  RayFunction channels[3];
};

/// Pixels of a row.
struct ShadedRow
{
  int count;
  const int* shades;     // of each pixel; what is computed where it is 0 and nothing is seen has no meaning
  const float* inverse;  // 1/w
  const float* xs;       // of each pixel's ray
  const float* ys;       // nullptr: all have `y`
  float y;
};

/// From the ray (x, y, 1) of the raster to the same ray in the optical frame: (xx x + xy y + x0, yy y + y0, 1).
struct RayFrame
{
  float xx;
  float xy;
  float x0;
  float yy;
  float y0;
};

struct ShadeKernels
{
  /// Writes the functions of three numbers that the vertices have, such as normals: `stride` floats from one result to
  /// the next.
  void (*functions)(const ShadedTriangles& triangles, const float* numbers, RayFunction* functions, int stride);

  /// Writes normals of length 1, a row for each coordinate. What is interpolated at an outline may point away from the
  /// camera a little: it is turned to the side.
  void (*normals)(const ShadedRow& row, const RayFrame& frame, const SurfaceShade* surfaces, float* const* normals);

  /// The same with the triangles' own normals.
  void (*flatNormals)(const ShadedRow& row, const SurfaceShade* surfaces, float* const* normals);

  /// Writes how much of a lamp's light falls on the pixels, 0 to 1. `to_light`: nullptr if the lamp is at the camera.
  void (*light)(const ShadedRow& row, const RayFrame& frame, const float* const* normals, const float* to_light,
                float* light);

  /// Writes the colors of vertices in this light, 0 to 255, a row for each channel.
  void (*colors)(const ShadedRow& row, const ColorShade* colors, const float* light, float* const* channels);
};

}  // namespace robot_vision
