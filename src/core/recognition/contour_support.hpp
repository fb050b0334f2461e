#pragma once

#include <vector>

#include "contour_points.hpp"
#include "contour_search.hpp"
#include "robot_vision/depth/depth_error.hpp"
#include "robot_vision/recognition/pose_verifier.hpp"

namespace robot_vision
{

/// Fills in which share of an object's contours a frame has. `points` are those of the region.
void compareContours(const RenderedRegion& region, const RecognitionFrame& frame,
                     const std::vector<ContourPoint>& points, const DepthErrorParams& errors,
                     const VerifierParams& params, PoseEvidence& evidence);

}  // namespace robot_vision
