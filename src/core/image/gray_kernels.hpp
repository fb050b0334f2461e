#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// The weights of the three colour channels in gray, 0 to 32639 each. They add up to 2^shift.
struct GrayWeights
{
  std::int16_t channels[3];
  int shift;
};

struct GrayKernels
{
  /// Writes the weighted means of pixels of 3 or 4 channels, rounded (halves up). The fourth channel does not count.
  /// Null where it would be no faster than cv::cvtColor.
  void (*gray)(const std::uint8_t* pixels, int channels, const GrayWeights& weights, int count, std::uint8_t* gray);
};

}  // namespace robot_vision
