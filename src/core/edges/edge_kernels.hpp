#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// Thresholds that the magnitude of the gradient must exceed.
struct EdgeThresholds
{
  std::int32_t low;
  std::int32_t high;
};

/// A row of gradients, and the magnitudes above and below it. The rows of magnitudes have one more on both sides.
template <class Magnitude>
struct Gradients
{
  const Magnitude* above;
  const Magnitude* row;
  const Magnitude* below;
  const std::int16_t* dx;
  const std::int16_t* dy;
};

/// The kernels for magnitudes |dx| + |dy| (std::int16_t) or dx^2 + dy^2 (std::int32_t).
template <class Magnitude>
struct EdgeKernels
{
  /// Writes the 3x3 Sobel derivatives and their magnitude. Reads one pixel before and one after each row.
  void (*gradient)(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below, int count,
                   std::int16_t* dx, std::int16_t* dy, Magnitude* magnitude);

  /// Non-maximum suppression as in cv::Canny. Writes 0, kCandidate, or kCandidate | kStrong.
  void (*suppress)(const Gradients<Magnitude>& gradients, const EdgeThresholds& thresholds, int count,
                   std::uint8_t* marks);
};

}  // namespace robot_vision
