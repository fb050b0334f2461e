#pragma once

#include <vector>

#include "haar_cascade.hpp"
#include "haar_kernels.hpp"

namespace robot_vision
{

/// How integral images lie in memory.
struct HaarLayout
{
  int row = 0;   // integers from one row to the next
  int half = 0;  // integers from a row's even columns to its odd ones, 0: they are not apart

  /// The index of a column and a row.
  int indexOf(int x, int y) const { return y * row + (half > 0 ? (x & 1) * half + (x >> 1) : x); }
};

/// A cascade for integral images of a layout.
struct PlacedCascade
{
  PlacedCascade() = default;
  PlacedCascade(const HaarCascade& cascade, const HaarLayout& of);
  PlacedCascade(PlacedCascade&&) = default;
  PlacedCascade& operator=(PlacedCascade&&) = default;

  HaarLayout layout;
  std::vector<PlacedStump> stumps;
  std::vector<PlacedStage> stages;  // point to the stumps

private:
  void place(const HaarStump& stump, double unit);
};

}  // namespace robot_vision
