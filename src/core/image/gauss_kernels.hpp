#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// What is added to the sums of GaussKernels::convolve_columns, which then fit signed words, and what that makes, with
/// the half for rounding, of the sum of 256 times as much.
constexpr int kSumBias = 0x8000;
constexpr int kMeanOffset = 256 * kSumBias + 0x8000;

constexpr int kWeighedRows = 4;   // that GaussKernels::convolve_columns makes at once
constexpr int kWeightMargin = 8;  // zeros before and after weights, which are read in twos and fours

/// The weights of a window's pixels from end to end, in 256ths, the same from both ends; twice, as both are used.
struct SymmetricWeights
{
  int half;  // of the window without its middle; at least 1
  const std::uint8_t* bytes;
  const std::uint16_t* words;

  /// Rows of a picture that kWeighedRows rows of sums are made of: as many more as make them fours.
  static constexpr int rows(int half) { return (2 * half + kWeighedRows + 3) / 4 * 4; }
};

struct GaussKernels
{
  /// kSumBias and the weighed sum of the pixels above each other in 2 * half + 1 rows: of those that begin with the
  /// first row, and with the three after it. Rows that only make fours of them have to be there, too.
  void (*convolve_columns)(const std::uint8_t* const* rows, const SymmetricWeights& weights, int count,
                           std::uint16_t* const* sums);
  /// The weighed mean, rounded, of such sums: of pixel i from i to i + 2 * half. Reads up to 128 sums and writes up to
  /// 64 means more.
  void (*convolve_row)(const std::uint16_t* sums, const SymmetricWeights& weights, int count, std::uint8_t* means);
};

}  // namespace robot_vision
