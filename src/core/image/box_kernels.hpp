#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// A rounded division by an odd `divisor` of at least 3 as a multiplication: (sum + half) * factor / 2^(16 + shift).
/// Holds for sums up to 255 * divisor.
struct Division
{
  explicit Division(int divisor);

  std::uint16_t half;
  std::uint16_t factor;
  int shift;
};

struct BoxKernels
{
  /// Moves the sums of columns by one row: sums += entering - leaving.
  void (*slide16)(const std::uint8_t* entering, const std::uint8_t* leaving, int count, std::uint16_t* sums);
  void (*slide32)(const std::uint8_t* entering, const std::uint8_t* leaving, int count, std::uint32_t* sums);

  /// Makes sums over more neighbours. `part[i]` is the sum of the `width` elements of `single` from index i on, and
  /// `wider[i]` becomes the sum of 2 * width of them, and of one more if `odd`. `wider` may be `part`.
  void (*widen16)(const std::uint16_t* single, const std::uint16_t* part, int width, bool odd, int count,
                  std::uint16_t* wider);
  void (*widen32)(const std::uint32_t* single, const std::uint32_t* part, int width, bool odd, int count,
                  std::uint32_t* wider);

  /// Writes (sum + half) * factor >> (16 + shift).
  void (*divide16)(const std::uint16_t* sums, const Division& by, int count, std::uint8_t* quotients);
  /// Writes sum * factor, rounded.
  void (*divide32)(const std::uint32_t* sums, float factor, int count, std::uint8_t* quotients);
};

}  // namespace robot_vision
