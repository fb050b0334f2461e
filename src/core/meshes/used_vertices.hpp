#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/meshes/mesh.hpp"

namespace robot_vision
{

/// The vertices of a valid mesh that triangles use (m); there may be others, which are not seen.
std::vector<cv::Vec3d> usedVertices(const Mesh& mesh);

}  // namespace robot_vision
