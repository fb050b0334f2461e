#pragma once

#include <vector>

#include "pose_refinement.hpp"

namespace robot_vision
{

/// Removes the planes of an observation that no pose near one of its corners' (`fits`) explains, too: they are of
/// something else, or their sensor is wrong. Returns whether any is left.
bool keepExplainedPlanes(const std::vector<PoseRefinement>& fits, const CameraModel& camera, Observation& observation);

}  // namespace robot_vision
