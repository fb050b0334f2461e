#pragma once

#include <ros/ros.h>

#include <vector>

#include "robot_vision/camera_controls.hpp"

namespace robot_vision
{

/// What ~controls, a map of names and values, and usb_cam's parameters ~brightness, ~autoexposure, ... set; the map's
/// come later. usb_cam's -1 leaves a control alone. Throws std::invalid_argument naming the parameter that is no
/// control's value.
std::vector<ControlSetting> readControlSettings(const ros::NodeHandle& pnh);

}  // namespace robot_vision
