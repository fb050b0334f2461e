#pragma once

#include <array>

/// The integer arithmetic of OpenCV's conversion to 8-bit HSV (modules/imgproc/src/color_hsv.simd.hpp), which
/// multiplies by rounded reciprocals of 12 fractional bits instead of dividing.
namespace robot_vision
{

constexpr int kHsvBits = 12;
constexpr int kHsvOne = 1 << kHsvBits;

/// scale / i in fixed point, rounded, for i from 1 to 255, and 0 for i = 0.
constexpr std::array<int, 256> makeReciprocals(int scale)
{
  std::array<int, 256> table = {};
  for (int i = 1; i < 256; ++i)
    table[i] = (2 * scale * kHsvOne + i) / (2 * i);
  return table;
}

constexpr std::array<int, 256> kSaturationFactors = makeReciprocals(255);
constexpr std::array<int, 256> kHueFactors = makeReciprocals(30);

/// numerator * factor, rounded to an integer (halves up).
constexpr int roundedProduct(int numerator, int factor)
{
  return (numerator * factor + kHsvOne / 2) >> kHsvBits;
}

/// The smallest product that is rounded to `value` or more.
constexpr int minProduct(int value)
{
  return value * kHsvOne - kHsvOne / 2;
}

}  // namespace robot_vision
