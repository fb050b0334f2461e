#pragma once

#include <sensor_msgs/CameraInfo.h>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// The camera of a camera_info, as it is: validate() says whether there can be such a camera.
CameraModel cameraModel(const sensor_msgs::CameraInfo& info);

}  // namespace robot_vision
