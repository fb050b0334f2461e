#pragma once

#include "robot_vision/camera/camera_controls.hpp"
#include "v4l2_device.hpp"

namespace robot_vision
{

/// The exposure time in seconds; 0 if the device does not tell it.
double exposureTime(V4l2Device& device);

}  // namespace robot_vision
