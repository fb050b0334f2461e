#pragma once

#include "robot_vision/camera/camera_controls.hpp"

namespace robot_vision
{

/// The value in the driver's terms: a number, or the text of a text control. Throws std::invalid_argument saying what
/// is possible.
ControlValue valueFor(const CameraControl& control, const ControlValue& value);

}  // namespace robot_vision
