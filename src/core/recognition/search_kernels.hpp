#pragma once

#include <cstdint>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

constexpr int kPlacesAtOnce = 64;
constexpr int kCodeContours = 64;  // features of a template, as far as places are searched for it
constexpr int kCodeSurfaces = 32;
constexpr int kCodeFeatures = kCodeContours + kCodeSurfaces;
constexpr int kCellBins = 16;       // of edges and of surfaces
constexpr int kDepthEdgeScore = 3;  // what a feature adds to a score
constexpr int kImageEdgeScore = 1;
constexpr int kSurfaceScore = 1;
constexpr int kOnlyEdgeScore = 2;  // the same where there are no depths, and all features of a code are edges
constexpr int kMaxScore = kCodeContours * kDepthEdgeScore + kCodeSurfaces * kSurfaceScore;
static_assert(kMaxScore < 255 && kCodeFeatures * kOnlyEdgeScore <= kMaxScore, "scores are bytes");

/// Where the cells of some places are in the bins and ranges of an ObservedFrame, and the depths that belong to an
/// object there.
struct PlaceLanes
{
  float x[kPlacesAtOnce], y[kPlacesAtOnce];                 // px, of the first window
  float across_x[kPlacesAtOnce], across_y[kPlacesAtOnce];   // px, from a cell to the next
  float along_x[kPlacesAtOnce], along_y[kPlacesAtOnce];     // px, to the next row of cells
  std::int32_t window[kPlacesAtOnce];                       // numbers to the bins of windows of its size
  std::uint32_t least[kPlacesAtOnce], most[kPlacesAtOnce];  // of ranges
};

/// The bins and ranges of the smallest windows, of the first pixel; those of larger ones follow.
struct SearchedFrame
{
  const std::uint32_t* bins;
  const std::uint32_t* ranges;  // nullptr: there are no depths
  int stride;                   // numbers from one row to the next
  int margin;                   // px around the image
  float width, height;          // px
};

/// A template is compared with kPlacesAtOnce places at a time. Around each place the image is divided into cells as
/// large as the place's distance makes them. A plane has a byte for each place, not 0 where the place has that bin in
/// that cell: the score of the feature. Edges of depth say most: few of them are where there is no object. A template
/// is the numbers of kCodeFeatures planes: kCellBins * cell + bin, where those of surfaces follow those of edges.
struct SearchKernels
{
  /// Writes the planes of the cell in this column and row: kCellBins * kPlacesAtOnce bytes.
  void (*gather)(const SearchedFrame& frame, const PlaceLanes& lanes, int column, int row, std::uint8_t* planes);

  /// A bit for each place whose score, the sum over the planes and 255 at most, is above its floor, as is twice the sum
  /// over the first half of them: that has half of each kind of features, and most templates are known by it not to
  /// fit. The scores are written only if there is such a place.
  std::uint64_t (*above)(const std::uint8_t* planes, const std::uint16_t* features, const std::uint8_t* floors,
                         std::uint8_t* scores);
};

}  // namespace robot_vision
