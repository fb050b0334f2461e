#pragma once

#include <ros/ros.h>

#include <vector>

#include "robot_vision/camera/camera_controls.hpp"

namespace robot_vision
{

/// What usb_cam's parameters ~brightness, ~autoexposure, ..., its map ~intrinsic_controls and ~controls, a map of names
/// and values, set; the maps' come later, in this order. usb_cam's -1 leaves a control alone, and so does the list
/// `ignore` in its map. Throws std::invalid_argument naming the parameter that is no control's value.
std::vector<ControlSetting> readControlSettings(const ros::NodeHandle& pnh);

}  // namespace robot_vision
