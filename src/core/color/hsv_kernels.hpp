#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

struct HsvTests;

constexpr std::uint8_t kUndecided = 1;  // what HsvKernels::hsv writes for pixels that it cannot decide

struct HsvKernels
{
  /// Writes 255, 0 or kUndecided for each pixel of three bytes, whose channels are in the order of those of the hue
  /// limits.
  void (*hsv)(const HsvTests& tests, const std::uint8_t* pixels, int count, std::uint8_t* mask);
};

}  // namespace robot_vision
