#pragma once

#include <cstddef>

namespace robot_vision
{

/// Reads a big-endian number of so many `bytes` at `at`.
template <std::size_t bytes>
std::size_t bigEndian(const unsigned char* at)
{
  std::size_t number = 0;
  for (std::size_t i = 0; i < bytes; ++i)
    number = number << 8 | at[i];
  return number;
}

}  // namespace robot_vision
