#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// Separable kernels of 3 or 5 taps whose sums fit 16 bits.
struct DerivativeKernels
{
  /// Writes the weighted sums of `taps` rows.
  void (*sum_rows)(const std::uint8_t* const* rows, const std::int16_t* weights, int taps, int count,
                   std::int16_t* sums);
  /// Writes the absolute values, limited to 255, of weighted sums over `taps` elements, `channels` apart, around each
  /// of `count` elements.
  void (*magnitudes)(const std::int16_t* sums, const std::int16_t* weights, int taps, int channels, int count,
                     std::uint8_t* magnitudes);
};

}  // namespace robot_vision
