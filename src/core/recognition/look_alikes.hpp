#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/meshes/mesh_renderer.hpp"

namespace robot_vision
{

/// The rotations about the center of a mesh, by parts of a turn about the axes of its frame, after which its surface is
/// where it was, but for 2 % of the diameter, while its colors are not.
std::vector<cv::Matx33d> findLookAlikes(const MeshRenderer& renderer);

}  // namespace robot_vision
