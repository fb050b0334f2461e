#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// The rays (x, y, 1) through the pixels of a row; NaN where the lens has none.
struct RayRow
{
  const float* x;
  const float* y;
};

/// Conversions of rows of depths. A float is a depth (m) if it is finite and above 0.
struct DepthKernels
{
  /// mm, 0: none, to m, NaN: none.
  void (*metres)(const std::uint16_t* millimetres, int count, float* metres);

  /// Writes depths as they are, and NaN for all else. Both rows may be the same.
  void (*depths)(const float* values, int count, float* depths);

  /// m to mm, rounded; 0 for what is no depth or beyond 16 bits.
  void (*millimetres)(const float* depths, int count, std::uint16_t* millimetres);

  /// Writes 1 / depth (1/m), 0 for what is no depth, nearer than 0.1 mm, or has no ray.
  void (*inverses)(const float* depths, const float* rays, int count, float* inverses);

  /// Writes x, y and z (m) of each pixel; NaN for what is no depth or has no ray.
  void (*points)(const float* depths, const RayRow& rays, int count, float* points);

  /// The same, with a fourth number after each of them: 1.
  void (*padded_points)(const float* depths, const RayRow& rays, int count, float* points);

  /// The same with a color as the fourth: 0x00RRGGBB as the bits of a float, as PCL and rviz read it.
  void (*colored_points)(const float* depths, const RayRow& rays, const std::uint8_t* bgr, int count, float* points);
};

}  // namespace robot_vision
