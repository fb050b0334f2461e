#pragma once

#include <ros/ros.h>

#include <vector>

#include "robot_vision/camera/camera_controls.hpp"

namespace robot_vision
{

/// Reads the settings of controls from usb_cam's parameters ~brightness, ~autoexposure, ..., then from usb_cam's map
/// ~intrinsic_controls, then from our map ~controls of names and values. usb_cam's value -1, and the list `ignore` in
/// its map, leave a control unchanged; ~focus switches the autofocus off unless ~autofocus is given. Throws
/// std::invalid_argument naming a parameter that cannot be a control's value.
std::vector<ControlSetting> readControlSettings(const ros::NodeHandle& pnh);

}  // namespace robot_vision
