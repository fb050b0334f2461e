#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>

namespace robot_vision
{

// The bins of what is compared between views and images, one bit each.
//
// Edges have eight bins for the direction across them, whatever its sign: bin k is that from k to k + 1 eighths of a
// half turn, from the image's x to its y. A direction in the image has the bin that it is in and the one that it is
// next to. An octant is half a bin.
//
// Surfaces have eight bins for their normal as seen along the ray to them: bin 0 for those that face the camera, and
// seven for the directions to which the others lean, bin 1 around x and then on to y. Those between two have both.

constexpr int kBins = 8;
constexpr int kSectors = kBins - 1;
constexpr double kFacing = 22.5;       // degrees between normal and ray, up to which a surface faces the camera
constexpr double kFacingMargin = 4.5;  // degrees, by which the bins overlap there
constexpr double kSectorMargin = 9.0;  // degrees, by which a sector is wider on both sides

/// The bin of the direction (rad) across an edge.
inline int edgeBin(double direction)
{
  const double turns = direction / CV_PI;
  return std::min(kBins - 1, static_cast<int>((turns - std::floor(turns)) * kBins));
}

/// The bin of a normal of length 1, to the camera, in a frame whose z is the ray.
inline int surfaceBin(double x, double y)
{
  constexpr double kRadians = CV_PI / 180.0;
  if (std::sqrt(x * x + y * y) < std::sin(kFacing * kRadians)) return 0;
  const double sectors = std::atan2(y, x) / (2.0 * CV_PI) * kSectors;
  const int nearest = static_cast<int>(std::floor(sectors + 0.5));
  return 1 + (nearest + kSectors) % kSectors;
}

}  // namespace robot_vision
