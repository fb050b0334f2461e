#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

struct ThresholdKernels
{
  /// Replaces each mean by 255 where a value is more than `difference` above it, and by 0 elsewhere; both are xored
  /// with `inversion`.
  void (*compare_with_mean)(const std::uint8_t* values, int difference, int inversion, int count, std::uint8_t* means);
};

}  // namespace robot_vision
