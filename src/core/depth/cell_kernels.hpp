#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"
#include "projection_kernels.hpp"

namespace robot_vision
{

constexpr int kMinCellSide = 2;  // px, of the cells that kernels draw
constexpr int kMaxCellSide = 4;  // px
constexpr int kCellsAtOnce = 64;
constexpr int kNoCell = -1;     // nothing is to be drawn
constexpr int kOtherCell = -2;  // has to be drawn otherwise

/// The rows of an image that cells are drawn into.
struct DrawnRows
{
  int width;        // px
  int begin;        // first row
  int end;          // last row, plus 1
  int stride;       // numbers from one row to the next
  int margin;       // px around them that may be drawn into, at least kMaxCellSide - 1
  float max_ratio;  // of the depths of one surface at the corners of a cell
};

/// A cell is the square between four vertices, and consists of two triangles. Its diagonal is the one whose ends differ
/// less.
struct CellKernels
{
  /// Draws the cells between two rows, kCellsAtOnce at most, that are one surface and in which at most N x N pixel
  /// centres may lie, with N = kMinCellSide, ... kMaxCellSide. values[k * kCellsAtOnce + i] becomes the inverse depth
  /// of cell i at pixel k % N, k / N of those, 0 where it is not. Of index[i], counted from the first number of the
  /// rows with their margin, is the first pixel; or it is kNoCell, or kOtherCell. Cells that are seen from behind are
  /// none.
  void (*draw[kMaxCellSide - kMinCellSide + 1])(const VertexRow& upper, const VertexRow& lower, const DrawnRows& rows,
                                                int count, std::int32_t* index, float* values);

  /// Inverse depths (1/m, 0: none) to depths in m, NaN: none, and in mm, 0: none or beyond 16 bits.
  void (*metres)(const float* inverses, int count, float* metres);
  void (*millimetres)(const float* inverses, int count, std::uint16_t* millimetres);
};

}  // namespace robot_vision
