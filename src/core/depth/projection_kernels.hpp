#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"
#include "depth_kernels.hpp"

namespace robot_vision
{

constexpr int kSubpixelBits = 8;
constexpr int kSubpixels = 1 << kSubpixelBits;  // steps of a vertex's position in a px

/// How a lens maps the plane z = 1 to that of its image.
enum class LensKind
{
  kPinhole,
  kPolynomial,   // that of cv::projectPoints with k1, k2, p1, p2, k3
  kRational,     // with k4, k5 and k6, too
  kEquidistant,  // that of cv::fisheye
};

/// From a depth camera's optical frame to the pixels of another camera.
struct Projection32
{
  LensKind kind;
  float rotation[9];
  float translation[3];  // m
  float fx, skew, cx, fy, cy;
  float k[8];        // k1, k2, p1, p2, k3, k4, k5, k6, or k1 to k4 of an equidistant lens
  float max_radius;  // on the plane z = 1, from the axis; farther out the lens sees nothing
};

/// Projected pixels of a depth image's row.
struct VertexRow
{
  std::int32_t* u;  // steps to the right of the centre of the top left pixel
  std::int32_t* v;  // steps down
  float* w;         // 1/m, the inverse of z in the other camera's optical frame; 0: none
};

struct ProjectionKernels
{
  /// Projects the pixels of a row of depths (m). There are none of those that are no depths, have no ray, are nearer
  /// than 1 mm or farther than 10 km, or outside of what the other camera can see.
  void (*project)(const float* depths, const RayRow& rays, const Projection32& to, int count, std::int32_t* u,
                  std::int32_t* v, float* w);
};

}  // namespace robot_vision
