#pragma once

#include <cstddef>

namespace robot_vision
{

/// The number whose bytes begin at `at`, the highest first.
template <std::size_t bytes>
std::size_t bigEndian(const unsigned char* at)
{
  std::size_t number = 0;
  for (std::size_t i = 0; i < bytes; ++i)
    number = number << 8 | at[i];
  return number;
}

}  // namespace robot_vision
