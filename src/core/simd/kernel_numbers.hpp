#pragma once

#include <cstdint>
#include <cstring>

/// What has to be inlined so that the loop around it becomes one over vectors.
#define ROBOT_VISION_INLINE [[gnu::always_inline]] inline

namespace robot_vision
{
namespace  // unnamed, so that each instruction set has a copy of its own
{

// Kernels are compiled for finite numbers. So NaN and infinities are found, and made, by the bits of a float (IEEE
// 754).

constexpr std::uint32_t kNanBits = 0x7FC00000;
constexpr std::uint32_t kInfinityBits = 0x7F800000;

inline std::uint32_t bitsOf(float value)
{
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

inline float fromBits(std::uint32_t bits)
{
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// Whether these are the bits of a finite number above 0.
inline bool isPositive(std::uint32_t bits)
{
  return bits - 1 < kInfinityBits - 1;
}

/// Whether these are the bits of a finite number.
inline bool isFiniteNumber(std::uint32_t bits)
{
  return (bits & kInfinityBits) != kInfinityBits;
}

ROBOT_VISION_INLINE float lesser(float a, float b)
{
  return a < b ? a : b;
}

ROBOT_VISION_INLINE float greater(float a, float b)
{
  return a > b ? a : b;
}

ROBOT_VISION_INLINE std::int32_t lesser(std::int32_t a, std::int32_t b)
{
  return a < b ? a : b;
}

ROBOT_VISION_INLINE std::int32_t greater(std::int32_t a, std::int32_t b)
{
  return a > b ? a : b;
}

/// 1 / sqrt(s) for s above 0, by Newton's method: unlike std::sqrt it makes vectors with every instruction set.
ROBOT_VISION_INLINE float inverseRoot(float s)
{
  constexpr std::uint32_t kGuess = 0x5F3759DF;  // halves the exponent, and is right within 4 %
  float root = fromBits(kGuess - (bitsOf(s) >> 1));
  root = root * (1.5F - 0.5F * s * root * root);
  root = root * (1.5F - 0.5F * s * root * root);
  return root * (1.5F - 0.5F * s * root * root);
}

/// The number, or NaN.
inline float valueIf(bool there, float value)
{
  return fromBits(there ? bitsOf(value) : kNanBits);
}

}  // namespace
}  // namespace robot_vision
