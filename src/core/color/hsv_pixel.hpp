#pragma once

#include <array>

/// The integer arithmetic of OpenCV's conversion to 8-bit HSV (modules/imgproc/src/color_hsv.simd.hpp): quotients are
/// products with rounded reciprocals of 12 fractional bits.
namespace robot_vision
{

constexpr int kHsvBits = 12;
constexpr int kHsvOne = 1 << kHsvBits;

/// scale / i in fixed point for i from 1 to 255, rounded; 0 for 0.
constexpr std::array<int, 256> makeReciprocals(int scale)
{
  std::array<int, 256> table = {};
  for (int i = 1; i < 256; ++i)
    table[i] = (2 * scale * kHsvOne + i) / (2 * i);
  return table;
}

constexpr std::array<int, 256> kSaturationFactors = makeReciprocals(255);
constexpr std::array<int, 256> kHueFactors = makeReciprocals(30);

/// numerator * factor without its fractional bits, rounded, halves up.
constexpr int roundedProduct(int numerator, int factor)
{
  return (numerator * factor + kHsvOne / 2) >> kHsvBits;
}

/// The least product with a reciprocal that is rounded to `value` or more.
constexpr int leastProduct(int value)
{
  return value * kHsvOne - kHsvOne / 2;
}

}  // namespace robot_vision
