#pragma once

#include "robot_vision/scene/scene.hpp"
#include "scene_view.hpp"

namespace robot_vision::scene
{

/// The ground truth of all objects at a time of the motion (s) for a camera with this pose in the world.
/// `poster_aspect` is the poster's width over its height.
SceneTruth truthAt(double seconds, const cv::Affine3d& pose, double poster_aspect, const Lens& lens);

}  // namespace robot_vision::scene
