#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// What an ObservedFrame has in windows of one size. The window of a position in the image is the one whose middle is
/// there; positions beside the image are moved to its margin.
struct LookFrame
{
  const std::uint32_t* bins;    // of the first pixel, see ObservedFrame
  const std::uint32_t* ranges;  // likewise
  int stride;                   // numbers from one row to the next
  int margin;                   // px around the image
  float width, height;          // px
  float fx, fy, cx, cy;         // px, of the top left corner of windows
  float inverse_steps;          // of 1/m, of the ranges
  float tolerance;              // m, of depths
};

/// The features of a view in the order of its code (SearchKernels), as far as a place is looked at: kCodeFeatures
/// numbers each, m from the anchor.
struct LookPoints
{
  const float* x;
  const float* y;
  const float* z;
};

struct LookPose
{
  float rotation[9];  // row by row, from the view to the camera's optical frame
  float anchor[3];    // m
};

/// How many features the frame shows, which it cannot show as something hides them, and where there is nothing as near.
struct LookCounts
{
  std::int32_t depth_edges, image_edges, hidden_edges, edges_beyond;
  std::int32_t surfaces, hidden_surfaces, surfaces_beyond;
};

/// A closer look at a template: with the depth of each feature, and where it exactly is. `features` is its code.
struct LookKernels
{
  void (*look)(const LookFrame& frame, const LookPoints& points, const LookPose& pose, const std::uint16_t* features,
               LookCounts& counts);

  /// The same for a frame without depths: only edges are counted, as those of the image.
  void (*look_at_image)(const LookFrame& frame, const LookPoints& points, const LookPose& pose,
                        const std::uint16_t* features, LookCounts& counts);
};

}  // namespace robot_vision
