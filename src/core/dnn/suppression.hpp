#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "candidates.hpp"

namespace robot_vision
{

using BoxOutline = std::array<cv::Point2d, 4>;

/// The corners of a box that is turned by its angle, clockwise from the one that is at the top left of it unturned.
BoxOutline outlineOf(const Candidate& candidate);

/// The area that two convex outlines with corners in the same sense, clockwise in an image, both cover.
double sharedArea(const BoxOutline& a, const BoxOutline& b);

/// Keeps at most max_detections of candidates that are sorted, as HeadDecoder says: non-maximum suppression.
std::vector<Candidate> suppress(const std::vector<Candidate>& sorted, const HeadParams& params);

}  // namespace robot_vision
