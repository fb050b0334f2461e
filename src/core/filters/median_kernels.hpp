#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// Medians of windows by sorting networks. The columns of a window are sorted once for all windows that have them; what
/// is left are Batcher's merges (Knuth, The Art of Computer Programming 3, 5.3.4) without what the median does not
/// need.
struct MedianKernels
{
  /// Sorts each column of `size` rows, and writes the least values to sorted[0]. `count` is at least `min_count`.
  void (*sort_columns)(const std::uint8_t* const* rows, int size, int count, std::uint8_t* const* sorted);
  /// Writes the medians of windows of `size` sorted columns, `channels` bytes apart, around each of `count` bytes.
  void (*medians)(const std::uint8_t* const* sorted, int size, int channels, int count, std::uint8_t* medians);
  int max_size;   // of the windows, which are of 7, 9, ... px; 0: there are no networks for this instruction set
  int min_count;  // bytes of a row
};

}  // namespace robot_vision
