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

struct EdgeKernels
{
  /// Writes the 3x3 Sobel derivatives and their magnitude, |dx| + |dy| (16 bits) or dx^2 + dy^2 (32 bits). Reads one
  /// pixel before and one after each row.
  void (*gradient16)(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below, int count,
                     std::int16_t* dx, std::int16_t* dy, std::int16_t* magnitude);
  void (*gradient32)(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below, int count,
                     std::int16_t* dx, std::int16_t* dy, std::int32_t* magnitude);

  /// Non-maximum suppression as in cv::Canny. Writes 0, kCandidate, or kCandidate | kStrong.
  void (*suppress16)(const Gradients<std::int16_t>& gradients, const EdgeThresholds& thresholds, int count,
                     std::uint8_t* marks);
  void (*suppress32)(const Gradients<std::int32_t>& gradients, const EdgeThresholds& thresholds, int count,
                     std::uint8_t* marks);
};

}  // namespace robot_vision
