#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// GaussKernels::convolve_columns adds kSumBias to its sums, which then fit signed words.
constexpr int kSumBias = 0x8000;
/// GaussKernels::convolve_row adds this to its sums, whose weights add up to 256: it removes the bias and rounds.
constexpr int kMeanOffset = 256 * kSumBias + 0x8000;

constexpr int kRowsAtOnce = 4;    // rows of sums that GaussKernels::convolve_columns computes in one call
constexpr int kWeightMargin = 8;  // zeros before and after the weights, which are read in pairs and in fours

/// The weights of a symmetric window from one end to the other, in 256ths. Kernels read them as bytes or as words.
struct SymmetricWeights
{
  int half;  // pixels on each side of the window's middle, at least 1
  const std::uint8_t* bytes;
  const std::uint16_t* words;

  /// Rows of the image that GaussKernels::convolve_columns reads: those of all windows, rounded up to a multiple of 4.
  static constexpr int rows(int half) { return (2 * half + kRowsAtOnce + 3) / 4 * 4; }
};

struct GaussKernels
{
  /// Writes kRowsAtOnce rows of weighted sums over columns of 2 * half + 1 pixels, plus kSumBias. The columns of
  /// sums[k] begin in rows[k]. SymmetricWeights::rows() rows are read, even those whose weights are 0.
  void (*convolve_columns)(const std::uint8_t* const* rows, const SymmetricWeights& weights, int count,
                           std::uint16_t* const* sums);
  /// Writes the rounded weighted means of such sums, of pixels with 1 to 4 `channels`; mean i is over every channels-th
  /// sum from i to i + 2 * half * channels. Reads up to 128 sums and writes up to 64 means beyond those asked for.
  void (*convolve_row)(const std::uint16_t* sums, const SymmetricWeights& weights, int channels, int count,
                       std::uint8_t* means);
};

}  // namespace robot_vision
