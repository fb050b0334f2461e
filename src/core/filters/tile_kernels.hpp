#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// What the tables of the four tiles around a pixel make of it.
struct TileRows
{
  const std::uint8_t* upper_left;
  const std::uint8_t* upper_right;
  const std::uint8_t* lower_left;
  const std::uint8_t* lower_right;
};

struct TileKernels
{
  /// Writes the values between the four, rounded. right[i] is the share of the tiles on the right of pixel i, left[i]
  /// the rest, `lower` and `upper` those of the rows of tiles. The sums are in float, in the order of OpenCV's.
  void (*interpolate)(const TileRows& rows, const float* left, const float* right, float upper, float lower, int count,
                      std::uint8_t* values);
};

}  // namespace robot_vision
