#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// A rounded division by an odd `divisor` of at least 3 as a multiplication. Holds for sums up to 255 * divisor.
struct BoxDivision
{
  explicit BoxDivision(int divisor);

  // For sums of 16 bits: (sum + half) * factor / 2^(16 + shift).
  std::uint16_t half;
  std::uint16_t factor;
  int shift;

  // For sums of 32 bits: sum * reciprocal. The float rounds correctly: an odd divisor allows no ties, and the quotients
  // next to a tie are further from it than the error of the multiplication.
  float reciprocal;
};

/// The kernels for sums of 16 or 32 bits (std::uint16_t, std::uint32_t).
template <class Sum>
struct BoxKernels
{
  /// Moves the sums of columns by one row: sums += entering - leaving.
  void (*slide)(const std::uint8_t* entering, const std::uint8_t* leaving, int count, Sum* sums);

  /// Makes sums over more neighbours. `part[i]` is the sum of the `width` elements of `single` from index i on, and
  /// `wider[i]` becomes the sum of 2 * width of them, and of one more if `odd`. `wider` may be `part`.
  void (*widen)(const Sum* single, const Sum* part, int width, bool odd, int count, Sum* wider);

  /// Writes the rounded quotients.
  void (*divide)(const Sum* sums, const BoxDivision& by, int count, std::uint8_t* quotients);
};

}  // namespace robot_vision
