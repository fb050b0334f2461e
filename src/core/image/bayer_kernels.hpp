#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// A row of a Bayer mosaic with its neighbours, from its second pixel on.
struct BayerRow
{
  const std::uint8_t* above;
  const std::uint8_t* row;
  const std::uint8_t* below;
  bool green_first;  // whether `row` points at a green pixel
  bool third;        // whether its other pixels are of the third channel of the result, else of the first
};

struct BayerKernels
{
  /// Pixels in BGR or RGB order, as cv::cvtColor makes them. Null: not faster than that.
  void (*bayer)(const BayerRow& row, int count, std::uint8_t* pixels);
};

}  // namespace robot_vision
