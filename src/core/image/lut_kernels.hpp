#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

struct LutKernels
{
  /// Replaces each value by its entry in a table of 256: cv::LUT.
  void (*apply_lut)(const std::uint8_t* table, const std::uint8_t* values, int count, std::uint8_t* results);
  bool has_fast_lut;  // whether looking up a value is faster than computing a linear function of it
};

}  // namespace robot_vision
