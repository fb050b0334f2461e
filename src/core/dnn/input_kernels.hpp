#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// Where the columns of a resized row are between those of the row that it is made of.
struct InputColumns
{
  const std::int32_t* first;  // the column to the left; rises
  const float* share;         // of the column to the right
};

/// Floats that InputKernels::blend_columns may read behind those it needs.
constexpr int kInputMargin = 64;

struct InputKernels
{
  /// Splits `count` pixels of three bytes into rows of their channels, a + (b - a) * share of two rows of the image.
  void (*blend_rows)(const std::uint8_t* a, const std::uint8_t* b, float share, int count, float* first, float* second,
                     float* third);
  /// Writes (a + (b - a) * share) * factor + offset of two neighbours in the row, for `count` columns.
  void (*blend_columns)(const float* row, const InputColumns& columns, int count, float factor, float offset,
                        float* values);
  /// Writes three rows of `count` numbers side by side.
  void (*interleave)(const float* first, const float* second, const float* third, int count, float* values);
};

}  // namespace robot_vision
