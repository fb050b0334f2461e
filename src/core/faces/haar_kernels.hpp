#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// Corners of a rectangle in an integral image, as indices from that of the window: upper left, upper right, lower
/// left, lower right.
using HaarCorners = std::int32_t[4];

/// A stump for integral images of a certain layout, with rounded votes.
struct PlacedStump
{
  HaarCorners corners[3];
  float weights[3];
  float threshold;
  std::int32_t below;  // vote
  std::int32_t above;
};

struct PlacedStage
{
  const PlacedStump* stumps;  // first those of two rectangles
  std::int32_t pairs;         // stumps of two rectangles
  std::int32_t count;         // all stumps
  std::int32_t rejected;      // fewer votes are too few for sure
  std::int32_t passed;        // so many votes are enough for sure
};

// What a stage makes of a window.
constexpr std::int32_t kRejected = 0;
constexpr std::int32_t kPassed = 1;
constexpr std::int32_t kUnsure = 2;  // rounding decides
constexpr std::int32_t kFlat = 3;    // nothing is to be seen in it

/// Windows of one row lie behind each other in the integral image. The kernels may read kHaarMargin integers behind
/// what belongs to the last window.
constexpr int kHaarMargin = 16;

struct HaarKernels
{
  /// The factor by which features of each of `count` windows are made independent of its contrast, as in OpenCV, or 0
  /// for flat ones; returns how many are not flat. `corners` are of a rectangle of `area` px, `sums` and `squares` the
  /// integral images.
  int (*contrasts)(const std::int32_t* sums, const std::int32_t* squares, const HaarCorners& corners, double area,
                   int count, float* factors);

  /// What the stage makes of each of `count` windows.
  void (*judge)(const PlacedStage& stage, const std::int32_t* sums, const float* factors, int count,
                std::uint8_t* verdicts);

  /// Of the `count` windows whose indices `windows` has, in ascending order, keeps those that the stage does not reject
  /// for sure; returns how many. Windows less than kHaarMargin apart must be of one row. Sets the verdict of those that
  /// the stage may reject to kUnsure.
  int (*keep)(const PlacedStage& stage, const std::int32_t* sums, const float* factors, std::int32_t* windows,
              int count, std::uint8_t* verdicts);
};

}  // namespace robot_vision
