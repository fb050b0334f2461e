#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// The weights of a colour's channels in its gray, 0 to 32639 each, 2^shift together.
struct GrayWeights
{
  std::int16_t channels[3];
  int shift;
};

struct GrayKernels
{
  /// The weighed sums of pixels of 3 or 4 channels, the fourth of which does not count, rounded (halves up). Null: not
  /// faster than cv::cvtColor.
  void (*gray)(const std::uint8_t* pixels, int channels, const GrayWeights& weights, int count, std::uint8_t* gray);
};

}  // namespace robot_vision
