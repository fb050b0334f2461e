#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

constexpr std::uint8_t kCandidate = 0x01;  // of BitKernels::split_marks
constexpr std::uint8_t kStrong = 0x80;

using BitWord = std::uint64_t;  // of kWordBits pixels, from the lowest bit on
constexpr int kWordBits = 64;

struct BitKernels
{
  /// Bits of pixels where two rows differ by more than the threshold; those beyond the last pixel are 0.
  void (*mark_differences)(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t threshold, int count,
                           BitWord* bits);
  /// Those of the pixels of so many words that have kCandidate and kStrong.
  void (*split_marks)(const std::uint8_t* marks, int words, BitWord* candidates, BitWord* strong);
  /// Bits that any of at least one row has.
  void (*unite)(const BitWord* const* rows, int number, int words, BitWord* united);
  /// Bits, and those as many places (1 to 63) before and after them. The words before and after the row's are 0.
  void (*unite_neighbours)(const BitWord* bits, int words, int places, BitWord* united);
  /// 255 for pixels whose bit is 1, else 0.
  void (*spread_bits)(const BitWord* bits, int count, std::uint8_t* bytes);
};

}  // namespace robot_vision
