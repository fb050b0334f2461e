#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// A row of a Bayer mosaic and the rows above and below it. All three pointers point at the second pixels of the rows.
struct BayerRow
{
  const std::uint8_t* above;
  const std::uint8_t* row;
  const std::uint8_t* below;
  bool green_first;  // whether `row` points at a green pixel
  bool third;        // whether the pixels of the row that are not green belong to the third channel, not to the first
};

struct BayerKernels
{
  /// Writes `count` pixels of three channels as cv::cvtColor does. Null where it would be no faster than OpenCV.
  void (*bayer)(const BayerRow& row, int count, std::uint8_t* pixels);
};

}  // namespace robot_vision
