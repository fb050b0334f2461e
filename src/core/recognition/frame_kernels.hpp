#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

constexpr int kMaxBlock = 4;     // px, of the squares that one pixel is made of
constexpr int kSlopeRadius = 2;  // px, of what a slope is measured by
constexpr std::uint32_t kNoRange = 0xFFFF0000;
constexpr float kMinStep = 0.012F;  // 1/m, of inverse depths at an edge: four times the noise of a Kinect, at any depth
constexpr float kOneSurface = 0.03F;  // largest difference of inverse depths of one surface, as a share of them

/// Three rows of the up to three channels of an image. One pixel before and behind them is read, too.
struct ChannelRows
{
  const std::uint8_t* above[3];
  const std::uint8_t* row[3];
  const std::uint8_t* below[3];
  int channels;
};

/// The rays (x, y, 1) through a row of pixels.
struct RayGeometry
{
  const float* x;
  const float* inverse_lengths;
  float y;
  float fx, fy;  // px
};

/// What is measured of the pixels of a row: `across` and `along` the rows, how the inverse depth changes with x and y
/// of the ray, and the bins of the normal, see feature_bins.hpp. No bins: there is no normal.
struct SlopeRow
{
  float* across;
  float* along;
  std::uint8_t* bins;
};

struct GradientRow
{
  std::int16_t* magnitudes;
  std::uint8_t* octants;  // 0 to 15, of the direction across an edge, see feature_bins.hpp
};

/// Loops over the rows of an image in which objects are looked for. Inverse depths are in 1/m, 0 is none. Rows of them
/// have kSlopeRadius more numbers before and behind them.
struct FrameKernels
{
  void (*inverses_of_millimetres)(const std::uint16_t* millimetres, int count, float* inverses);
  void (*inverses_of_metres)(const float* metres, int count, float* inverses);

  /// Of each square of 1, ..., kMaxBlock px the mean of what belongs to the nearest surface in it.
  void (*nearest[kMaxBlock])(const float* const* rows, int count, float* inverses);

  /// The slopes of inverse depths and the bins of normals, of the row in the middle of five.
  void (*slopes)(const float* const* rows, const RayGeometry& rays, int count, const SlopeRow& slopes);

  /// Bins of the edges of what is nearer than something beside it by the share `jump`, and by kMinStep, or than
  /// nothing. What goes on with the slope of the pixel is not farther.
  void (*depth_edges)(const float* const* rows, const RayGeometry& rays, const SlopeRow& slopes, float jump, int count,
                      std::uint8_t* bins);

  /// The gradient of that channel in which it is largest.
  void (*gradients)(const ChannelRows& rows, int count, const GradientRow& gradients);

  /// The bins of edges, thinned, whose magnitude is at least the threshold. One pixel before and behind the rows
  /// is read, too.
  void (*edges)(const std::int16_t* above, const std::int16_t* row, const std::int16_t* below,
                const std::uint8_t* octants, int threshold, int count, std::uint8_t* bins);

  /// The bins of edges of the image in the lowest byte, of edges of depth in the next one, then of surfaces.
  void (*join)(const std::uint8_t* edges, const std::uint8_t* depth_edges, const std::uint8_t* surfaces, int count,
               std::uint32_t* joined);

  /// Inverse depths in steps of 1 / `steps` as ranges: that of the nearest in the lower 16 bits, that of the farthest
  /// in the upper ones. None is kNoRange.
  void (*ranges)(const float* inverses, float steps, int count, std::uint32_t* ranges);

  /// Of a pixel, that `shift` px to its right and the same two of another row: the bins that any has, and the range of
  /// all. The rows that are read may be the same.
  void (*unite)(const std::uint32_t* row, const std::uint32_t* other, int shift, int count, std::uint32_t* united);
  void (*widen)(const std::uint32_t* row, const std::uint32_t* other, int shift, int count, std::uint32_t* ranges);
};

}  // namespace robot_vision
