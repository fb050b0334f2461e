#pragma once

#include <vector>

#include "candidates.hpp"
#include "robot_vision/dnn/box_outline.hpp"

namespace robot_vision
{

/// The corners of a box that is turned by its angle, clockwise from the one that is at the top left of it unturned.
BoxOutline outlineOf(const Candidate& candidate);

/// Keeps at most max_detections of candidates that are sorted, as HeadDecoder says: non-maximum suppression.
std::vector<Candidate> suppress(const std::vector<Candidate>& sorted, const HeadParams& params);

}  // namespace robot_vision
