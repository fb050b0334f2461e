#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

// Bits of the bytes that BitKernels::split_marks reads, as Canny's edge detector marks pixels.
constexpr std::uint8_t kCandidate = 0x01;
constexpr std::uint8_t kStrong = 0x80;

/// One bit for each of kWordBits pixels; the first pixel has the lowest bit.
using BitWord = std::uint64_t;
constexpr int kWordBits = 64;

struct BitKernels
{
  /// Sets the bits of pixels at which two rows differ by more than the threshold. Bits beyond the last pixel become 0.
  void (*mark_differences)(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t threshold, int count,
                           BitWord* bits);
  /// Sets the bits of pixels whose marks have kCandidate, and of those whose marks have kStrong, for as many pixels as
  /// `words` have bits.
  void (*split_marks)(const std::uint8_t* marks, int words, BitWord* candidates, BitWord* strong);
  /// Writes the bitwise OR of `number` rows, which is at least 1.
  void (*unite)(const BitWord* const* rows, int number, int words, BitWord* united);
  /// Writes the bitwise OR of a row with itself, shifted by `places` (1 to 63) pixels to the left and to the right. The
  /// words before and after the row are read, and must be 0.
  void (*unite_neighbours)(const BitWord* bits, int words, int places, BitWord* united);
  /// Writes 255 for pixels whose bit is 1, else 0.
  void (*spread_bits)(const BitWord* bits, int count, std::uint8_t* bytes);
};

}  // namespace robot_vision
