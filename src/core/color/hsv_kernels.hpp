#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

struct HsvTests;

constexpr std::uint8_t kUnsure = 1;  // of HsvKernels::hsv

struct HsvKernels
{
  /// 255, 0 or kUnsure for pixels of three bytes in the order that the hue limits have.
  void (*hsv)(const HsvTests& tests, const std::uint8_t* pixels, int count, std::uint8_t* mask);
};

}  // namespace robot_vision
