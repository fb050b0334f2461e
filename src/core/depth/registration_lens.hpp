#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "projection_kernels.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// How far from the axis, on the plane z = 1, a lens sees something that is at most `margin` (px) outside of its image.
/// There the distortion model holds: much farther out a polynomial may lead back into the image.
double lensRadius(const CameraModel& camera, double margin);

/// From a frame to the pixels of a camera. `to_camera` takes points of that frame to the camera's optical frame.
Projection32 projection32(const CameraModel& camera, const cv::Affine3d& to_camera, double radius);

}  // namespace robot_vision
