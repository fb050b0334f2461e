#pragma once

#include "robot_vision/camera/camera_controls.hpp"

namespace robot_vision
{

/// Converts a value to the type that the driver takes: a number, or a text for a text control. Throws
/// std::invalid_argument that says which values are possible.
ControlValue valueFor(const CameraControl& control, const ControlValue& value);

}  // namespace robot_vision
