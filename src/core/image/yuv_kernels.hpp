#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// How a row of YUV has its chroma, of which pairs of pixels have one sample: between the luma, or in rows of its own,
/// as pairs (in `u` of YuvRow) or in two planes.
enum class YuvLayout
{
  kYuyv,
  kUyvy,
  kUv,
  kVu,
  kPlanes
};

struct YuvRow
{
  const std::uint8_t* luma;
  const std::uint8_t* u;
  const std::uint8_t* v;
};

constexpr int kMinRow = 64;  // pixels that a row of YuvKernels::yuv and BayerKernels::bayer has

struct YuvKernels
{
  /// The first of every two.
  void (*every_second)(const std::uint8_t* values, int count, std::uint8_t* results);

  /// Pixels in BGR or RGB order, as cv::cvtColor makes them. Null: not faster than that.
  void (*yuv)(const YuvRow& row, YuvLayout layout, int pairs, bool is_rgb, std::uint8_t* pixels);
};

}  // namespace robot_vision
