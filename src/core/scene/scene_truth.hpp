#pragma once

#include <cstdint>

#include "robot_vision/scene/scene.hpp"
#include "scene_view.hpp"

namespace robot_vision::scene
{

/// Everything about the objects at a time of the motion, in seconds, as a camera (its pose in the world) sees them;
/// `poster_aspect` is width over height.
SceneTruth truthAt(double seconds, const cv::Affine3d& pose, double poster_aspect, const Lens& lens);

}  // namespace robot_vision::scene
