#pragma once

#include <cstdint>

namespace robot_vision::scene
{

/// Hashes a number to 64 well mixed bits, by the finaliser of SplitMix64.
inline std::uint64_t mix(std::uint64_t value)
{
  value += 0x9e3779b97f4a7c15;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9;
  value = (value ^ (value >> 27)) * 0x94d049bb133111eb;
  return value ^ (value >> 31);
}

/// The upper 53 bits of a hash as a double in [0, 1).
inline double unitInterval(std::uint64_t mixed)
{
  return static_cast<double>(mixed >> 11) * 0x1.0p-53;
}

}  // namespace robot_vision::scene
