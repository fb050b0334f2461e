#pragma once

#include <cstdint>

namespace robot_vision
{

/// Whether this machine has the lowest byte of a number first.
inline bool isLittleEndianHost()
{
  const std::uint16_t one = 1;
  return *reinterpret_cast<const unsigned char*>(&one) == 1;
}

}  // namespace robot_vision
