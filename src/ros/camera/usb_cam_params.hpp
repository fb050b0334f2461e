#pragma once

#include <ros/ros.h>

namespace robot_vision
{

/// Accepts the parameters of usb_cam that have no effect here. For each one that is set, a log line says what holds.
void acceptUsbCamParams(const ros::NodeHandle& pnh);

}  // namespace robot_vision
