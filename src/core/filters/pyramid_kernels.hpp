#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// The window of cv::pyrDown, 1 4 6 4 1 in both directions.
struct PyramidKernels
{
  /// Writes the weighted sums of five rows, at most 16 * 255.
  void (*sum_rows)(const std::uint8_t* const* rows, int count, std::uint16_t* sums);
  /// Writes the rounded means around every other pixel of a row of such sums, from its first one on. `sums` go on for
  /// two pixels beyond both ends. `blurred` has room for the means around all `pixels`.
  void (*halve_row)(const std::uint16_t* sums, int channels, int pixels, std::uint8_t* blurred, std::uint8_t* halved);
};

}  // namespace robot_vision
