#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

struct BrightnessKernels
{
  /// Writes value * gain + offset, rounded (halves to even) and limited to 0 to 255.
  void (*line)(const std::uint8_t* values, float gain, float offset, int count, std::uint8_t* results);
};

}  // namespace robot_vision
