#pragma once

#include <cstdint>

#include "loops.hpp"

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

void unite(const std::uint8_t* a, const std::uint8_t* b, int count, std::uint8_t* united)
{
  // What is written was read before, by this or an earlier index.
  ROBOT_VISION_INDEPENDENT
  for (int i = 0; i < count; ++i)
    united[i] = a[i] | b[i];
}

}  // namespace
}  // namespace robot_vision
