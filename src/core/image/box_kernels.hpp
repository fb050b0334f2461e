#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// The quotient of a sum and an odd `divisor` from 3 on, rounded: (sum + half) * factor / 2^(16 + shift), for sums to
/// 255 * divisor.
struct Division
{
  explicit Division(int divisor);

  std::uint16_t half;
  std::uint16_t factor;
  int shift;
};

struct BoxKernels
{
  /// sums += entering - leaving
  void (*slide16)(const std::uint8_t* entering, const std::uint8_t* leaving, int count, std::uint16_t* sums);
  void (*slide32)(const std::uint8_t* entering, const std::uint8_t* leaving, int count, std::uint32_t* sums);

  /// Of `part`, the sums of `width` neighbours in `single` (the one with the index and those after it), those of twice
  /// as many, and of one more if `odd`. `wider` may be `part`.
  void (*widen16)(const std::uint16_t* single, const std::uint16_t* part, int width, bool odd, int count,
                  std::uint16_t* wider);
  void (*widen32)(const std::uint32_t* single, const std::uint32_t* part, int width, bool odd, int count,
                  std::uint32_t* wider);

  /// (sum + half) * factor >> (16 + shift)
  void (*divide16)(const std::uint16_t* sums, const Division& by, int count, std::uint8_t* quotients);
  /// sum * factor, rounded
  void (*divide32)(const std::uint32_t* sums, float factor, int count, std::uint8_t* quotients);
};

}  // namespace robot_vision
