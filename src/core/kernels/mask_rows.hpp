#pragma once

#include <cstdint>

#include "vectors.hpp"

namespace robot_vision
{
namespace  // one for each instruction set
{

void markDifferences(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t threshold, int count,
                     std::uint8_t* __restrict mask)
{
  for (int i = 0; i < count; ++i)
  {
    const std::uint8_t larger = a[i] > b[i] ? a[i] : b[i];
    const std::uint8_t smaller = a[i] > b[i] ? b[i] : a[i];
    mask[i] = static_cast<std::uint8_t>(larger - smaller) > threshold ? 255 : 0;
  }
}

/// Up to kUnited columns.
constexpr int kUnited = 64;

void uniteInLoops(const std::uint8_t* const* rows, int number, int begin, int count, std::uint8_t* united)
{
  std::uint8_t bits[kUnited];
  for (int i = 0; i < count; ++i)
    bits[i] = rows[0][begin + i];
  for (int j = 1; j < number; ++j)
    for (int i = 0; i < count; ++i)
      bits[i] |= rows[j][begin + i];
  for (int i = 0; i < count; ++i)
    united[begin + i] = bits[i];
}

void unite(const std::uint8_t* const* rows, int number, int count, std::uint8_t* united)
{
  int begin = 0;
#ifdef ROBOT_VISION_VECTORS
  constexpr int kBytes = static_cast<int>(sizeof(Simd::Vector));
  for (; begin + kBytes <= count; begin += kBytes)
  {
    Simd::Vector bits = Simd::load(rows[0] + begin);
    for (int j = 1; j < number; ++j)
      bits = Simd::eitherBits(bits, Simd::load(rows[j] + begin));
    Simd::store(united + begin, bits);
  }
#endif
  for (; begin < count; begin += kUnited)
    uniteInLoops(rows, number, begin, count - begin < kUnited ? count - begin : kUnited, united);
}

}  // namespace
}  // namespace robot_vision
