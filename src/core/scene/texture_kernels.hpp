#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision::scene
{

/// A texture as a run of pixels sees it.
struct TexturePlane
{
  const std::uint32_t* texels;  // from the upper left of the border; B, G, R and alpha, from the lowest bits
  int width;                    // texels, without the border of one texel on each side
  int height;
  float plane[9];  // row by row: maps a ray (x, y, 1) to (u, v, 1) times a number, the content being the unit square
};

struct TextureKernels
{
  static constexpr int kMaxRun = 64;  // pixels

  /// Draws what the rays of a run of at most kMaxRun pixels meet over these pixels, in BGR: the color between the four
  /// nearest texels, mixed in by its alpha.
  void (*draw)(const TexturePlane& texture, const float* xs, const float* ys, int count, std::uint8_t* pixels);
};

}  // namespace robot_vision::scene
