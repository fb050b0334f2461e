#pragma once

#include "oriented_points.hpp"
#include "robot_vision/meshes/mesh.hpp"

namespace robot_vision
{

/// Points all over a mesh that are a distance (m) apart, or a little more, the same each time.
OrientedPoints sampleSurface(const Mesh& mesh, double distance);

}  // namespace robot_vision
