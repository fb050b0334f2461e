#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// Where a row has its chroma, of which each pair of pixels has one sample.
enum class YuvLayout
{
  kYuyv,   // between the luma
  kUyvy,   // between the luma
  kUv,     // in YuvRow::u as pairs
  kVu,     // in YuvRow::u as pairs
  kPlanes  // in YuvRow::u and YuvRow::v
};

struct YuvRow
{
  const std::uint8_t* luma;
  const std::uint8_t* u;
  const std::uint8_t* v;
};

constexpr int kMinRowPixels = 64;  // px, the shortest row that YuvKernels::yuv and BayerKernels::bayer can convert

struct YuvKernels
{
  /// Copies the first of every two values; `count` is the number of results.
  void (*every_second)(const std::uint8_t* values, int count, std::uint8_t* results);

  /// Writes pairs of pixels in BGR or RGB order as cv::cvtColor does. Null where it would be no faster than OpenCV.
  void (*yuv)(const YuvRow& row, YuvLayout layout, int pairs, bool is_rgb, std::uint8_t* pixels);
};

}  // namespace robot_vision
