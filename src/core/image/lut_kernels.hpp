#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

struct TableKernels
{
  /// Values' places in a table of 256.
  void (*apply_lut)(const std::uint8_t* table, const std::uint8_t* values, int count, std::uint8_t* results);
  bool has_fast_lut;  // faster than to compute
};

}  // namespace robot_vision
