#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision::scene
{

/// The pose in the optical frame of a board of `size` (m) that is shown to a camera in view number `view` (0, 1, ...).
/// The whole board is in the image.
cv::Affine3d shownBoard(int view, const cv::Size2d& size, const CameraModel& camera);

}  // namespace robot_vision::scene
