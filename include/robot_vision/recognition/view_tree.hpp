#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/recognition/symmetry.hpp"

namespace robot_vision
{

/// A direction that an object is looked at from.
struct ViewDirection
{
  cv::Vec3d direction;  // of length 1, in the object's frame, from its middle to the camera
  double spin = 0.0;  // rad, turns about the line of sight up to this look different: 2 pi, less on an axis of symmetry
  int parent = -1;    // the nearest direction of the levels above; -1: one of the coarsest level
};

/// Directions that are about equally far from each other, from coarse to fine: each level has the directions of those
/// above, and as many between them that none is farther than about half as much from the nearest one.
struct ViewTree
{
  std::vector<ViewDirection> directions;  // those of the coarsest level first
  std::vector<int> levels;                // how many directions each level has, together with those above
};

constexpr int kMaxSubdivisions = 3;

/// The corners of an icosahedron whose triangles are divided in four `subdivisions` times (12, 42, 162 or 642
/// directions); for an object with symmetries as few directions as are as near as these to each direction that looks
/// different. The same for the same arguments. Throws std::invalid_argument for subdivisions that are not from 0 to 3.
ViewTree viewTree(int subdivisions, const SymmetryGroup& symmetries = SymmetryGroup());

/// The largest angle (rad) between any direction and the nearest corner of an icosahedron divided so often, from 0 to
/// kMaxSubdivisions times.
double largestGap(int subdivisions);

/// The rotation of an object, in the camera's optical frame, that is looked at from this direction (of length 1, in the
/// object's frame). The object's z is
/// up in the image, or its y if z points to the camera or away from it.
cv::Matx33d lookedAtFrom(const cv::Vec3d& direction);

}  // namespace robot_vision
