#pragma once

#include <cstdint>

#include "../hsv_tests.hpp"
#include "kernels.hpp"

namespace robot_vision
{
namespace  // one for each instruction set
{

inline std::uint8_t larger(std::uint8_t a, std::uint8_t b)
{
  return a > b ? a : b;
}

inline std::uint8_t smaller(std::uint8_t a, std::uint8_t b)
{
  return a < b ? a : b;
}

inline std::int16_t smaller(std::int16_t a, std::int16_t b)
{
  return a < b ? a : b;
}

// One loop of 8- and 16-bit integers without branches: compilers make vectors of it.
void applyTests(const HsvTests& tests, const std::uint8_t* __restrict pixels, int count, std::uint8_t* __restrict mask)
{
  using Byte = std::uint8_t;
  using Short = std::int16_t;
  const HsvTests t = tests;  // a copy cannot be changed by the writes to `mask`
  for (int i = 0; i < count; ++i)
  {
    const Byte first = pixels[3 * i];
    const Byte second = pixels[3 * i + 1];
    const Byte third = pixels[3 * i + 2];
    const Byte max = larger(first, larger(second, third));
    const Byte diff = static_cast<Byte>(max - smaller(first, smaller(second, third)));
    const Byte v_inside = (max >= t.v_low ? 255 : 0) & (max <= t.v_high ? 255 : 0);

    const Short s_low = static_cast<Short>(t.s_low.diff * diff - t.s_low.value * max - t.s_low.offset);
    const Short s_above = static_cast<Short>(t.s_above.diff * diff - t.s_above.value * max - t.s_above.offset);
    const Short s = smaller(s_low, static_cast<Short>(~s_above));

    const Short x = static_cast<Short>(second - first);  // the factors add up to 0: two differences are enough
    const Short y = static_cast<Short>(third - first);
    const Short h_low = static_cast<Short>(t.h_low.channels[1] * x + t.h_low.channels[2] * y - t.h_low.offset);
    const Short h_above = static_cast<Short>(t.h_above.channels[1] * x + t.h_above.channels[2] * y - t.h_above.offset);
    const Short h = static_cast<Short>(smaller(h_low, static_cast<Short>(~h_above)) ^ t.h_outside);
    const Short h_slack = static_cast<Short>(static_cast<std::uint16_t>(t.h_slack * diff + 255) >> 8);

    const Byte inside = (s >= t.s_slack ? 255 : 0) & (h >= h_slack ? 255 : 0);
    const Byte perhaps =
        (s >= static_cast<Short>(-t.s_slack) ? kUnsure : 0) & (h >= static_cast<Short>(-h_slack) ? kUnsure : 0);
    mask[i] = (inside | perhaps) & v_inside;
  }
}

}  // namespace
}  // namespace robot_vision
