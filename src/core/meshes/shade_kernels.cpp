#include "shade_kernels.hpp"

#include <cstddef>

#include "core/simd/kernel_numbers.hpp"

namespace robot_vision
{
namespace
{

inline float at(const RayFunction& f, float x, float y)
{
  return f.x * x + (f.y * y + f.one);
}

constexpr int kLanes = 8;  // triangles that are worked on at a time, for vectors

/// The corners of some triangles, and their numbers.
struct Corners
{
  double x[3][kLanes], y[3][kLanes], w[3][kLanes];
  float numbers[9][kLanes];  // three of each corner
};

inline void gather(const ShadedTriangles& triangles, int begin, const float* numbers, Corners& c)
{
  for (int lane = 0; lane < kLanes; ++lane)
  {
    const int last = triangles.count - 1;  // stands for those beyond the end
    const int* corners = triangles.corners + 3 * triangles.triangles[begin + lane < last ? begin + lane : last];
    for (int k = 0; k < 3; ++k)
    {
      const SeenVertex& vertex = triangles.vertices[corners[k]];
      c.x[k][lane] = vertex.x;
      c.y[k][lane] = vertex.y;
      c.w[k][lane] = vertex.w;
      for (int i = 0; i < 3; ++i)
        c.numbers[3 * k + i][lane] = numbers[3 * corners[k] + i];
    }
  }
}

/// The weights of the corners as functions of the ray, divided by w: three coefficients of each of three corners.
inline void weigh(const Corners& c, float (&weights)[9][kLanes])
{
  for (int i = 0; i < kLanes; ++i)
  {
    const double ax = c.x[0][i], ay = c.y[0][i], aw = c.w[0][i];
    const double bx = c.x[1][i], by = c.y[1][i], bw = c.w[1][i];
    const double cx = c.x[2][i], cy = c.y[2][i], cw = c.w[2][i];
    const double x = by * cw - bw * cy, y = bw * cx - bx * cw, w = bx * cy - by * cx;
    const double inverse = 1.0 / (ax * x + ay * y + aw * w);
    weights[0][i] = static_cast<float>(x * inverse);
    weights[1][i] = static_cast<float>(y * inverse);
    weights[2][i] = static_cast<float>(w * inverse);
    weights[3][i] = static_cast<float>((cy * aw - cw * ay) * inverse);
    weights[4][i] = static_cast<float>((cw * ax - cx * aw) * inverse);
    weights[5][i] = static_cast<float>((cx * ay - cy * ax) * inverse);
    weights[6][i] = static_cast<float>((ay * bw - aw * by) * inverse);
    weights[7][i] = static_cast<float>((aw * bx - ax * bw) * inverse);
    weights[8][i] = static_cast<float>((ax * by - ay * bx) * inverse);
  }
}

void functions(const ShadedTriangles& triangles, const float* numbers, RayFunction* functions, int stride)
{
  for (int begin = 0; begin < triangles.count; begin += kLanes)
  {
    Corners corners;
    float weights[9][kLanes], results[9][kLanes];
    gather(triangles, begin, numbers, corners);
    weigh(corners, weights);
    for (int number = 0; number < 3; ++number)
      for (int part = 0; part < 3; ++part)
        for (int i = 0; i < kLanes; ++i)
          results[3 * number + part][i] = corners.numbers[number][i] * weights[part][i] +
                                          corners.numbers[3 + number][i] * weights[3 + part][i] +
                                          corners.numbers[6 + number][i] * weights[6 + part][i];
    for (int lane = 0; lane < kLanes && begin + lane < triangles.count; ++lane)
    {
      auto* to = reinterpret_cast<float*>(functions) + static_cast<std::ptrdiff_t>(begin + lane) * stride;
      for (int i = 0; i < 9; ++i)
        to[i] = results[i][lane];
    }
  }
}

template <bool kLens>
inline void normalsOf(const ShadedRow& row, const RayFrame& frame, const SurfaceShade* surfaces,
                      float* const* __restrict normals)
{
  const RayFrame f = frame;
  for (int i = 0; i < row.count; ++i)
  {
    const SurfaceShade& surface = surfaces[row.shades[i]];
    const float x = row.xs[i], y = kLens ? row.ys[i] : row.y;
    float nx = at(surface.normal[0], x, y), ny = at(surface.normal[1], x, y), nz = at(surface.normal[2], x, y);
    const float dx = f.xx * x + (f.xy * y + f.x0), dy = f.yy * y + f.y0;
    const float away = nx * dx + ny * dy + nz;
    if (away > 0.0F)  // seldom
    {
      const float share = away / (dx * dx + dy * dy + 1.0F);
      nx -= share * dx;
      ny -= share * dy;
      nz -= share;
    }
    const float squared = nx * nx + ny * ny + nz * nz;
    const bool any = squared > 0.0F;
    const float inverse = inverseRoot(any ? squared : 1.0F);
    normals[0][i] = any ? nx * inverse : surface.flat[0];
    normals[1][i] = any ? ny * inverse : surface.flat[1];
    normals[2][i] = any ? nz * inverse : surface.flat[2];
  }
}

void normals(const ShadedRow& row, const RayFrame& frame, const SurfaceShade* surfaces, float* const* normals)
{
  if (row.ys != nullptr)
    normalsOf<true>(row, frame, surfaces, normals);
  else
    normalsOf<false>(row, frame, surfaces, normals);
}

void flatNormals(const ShadedRow& row, const SurfaceShade* surfaces, float* const* normals)
{
  for (int i = 0; i < row.count; ++i)
    for (int axis = 0; axis < 3; ++axis)
      normals[axis][i] = surfaces[row.shades[i]].flat[axis];
}

void light(const ShadedRow& row, const RayFrame& frame, const float* const* normals, const float* to_light,
           float* __restrict light)
{
  const RayFrame f = frame;
  const float* __restrict nx = normals[0];
  const float* __restrict ny = normals[1];
  const float* __restrict nz = normals[2];
  for (int i = 0; i < row.count; ++i)
  {
    float facing;
    if (to_light != nullptr)
      facing = nx[i] * to_light[0] + ny[i] * to_light[1] + nz[i] * to_light[2];
    else
    {
      const float y = row.ys != nullptr ? row.ys[i] : row.y;
      const float dx = f.xx * row.xs[i] + (f.xy * y + f.x0), dy = f.yy * y + f.y0;
      facing = -(nx[i] * dx + ny[i] * dy + nz[i]) * inverseRoot(dx * dx + dy * dy + 1.0F);
    }
    light[i] = facing > 0.0F ? facing : 0.0F;
  }
}

void colors(const ShadedRow& row, const ColorShade* colors, const float* light, float* const* channels)
{
  float* __restrict blue = channels[0];
  float* __restrict green = channels[1];
  float* __restrict red = channels[2];
  for (int i = 0; i < row.count; ++i)
  {
    const ColorShade& color = colors[row.shades[i]];
    const float x = row.xs[i], y = row.ys != nullptr ? row.ys[i] : row.y;
    const float w = light[i] / row.inverse[i];
    blue[i] = at(color.channels[0], x, y) * w;
    green[i] = at(color.channels[1], x, y) * w;
    red[i] = at(color.channels[2], x, y) * w;
  }
}

}  // namespace

template <>
const ShadeKernels KernelTable<ShadeKernels, ROBOT_VISION_SET>::table = {functions, normals, flatNormals, light,
                                                                         colors};

}  // namespace robot_vision
