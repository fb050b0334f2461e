#pragma once

#include <ros/ros.h>

namespace robot_vision
{

/// Takes the parameters of usb_cam that mean nothing here, and says in one line for each that is there what holds.
void acceptUsbCamParams(const ros::NodeHandle& pnh);

}  // namespace robot_vision
