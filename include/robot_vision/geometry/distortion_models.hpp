#pragma once

#include <string>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// Whether the name is one of the distortion models of cv::fisheye.
bool isEquidistant(const std::string& distortion_model);
/// Whether the name is one of the distortion models of cv::projectPoints.
bool isPolynomial(const std::string& distortion_model);
/// Whether the camera has a lens that a pinhole has not: an equidistant one bends rays with all coefficients 0, too.
bool isDistorted(const CameraModel& camera);

}  // namespace robot_vision
