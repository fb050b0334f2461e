#pragma once

#include "robot_vision/camera/camera_controls.hpp"
#include "v4l2_device.hpp"

namespace robot_vision
{

/// Seconds that a picture is exposed for; 0: the device does not say.
double exposureTime(V4l2Device& device);

}  // namespace robot_vision
