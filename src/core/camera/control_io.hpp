#pragma once

#include <linux/videodev2.h>

#include "robot_vision/camera/camera_controls.hpp"
#include "v4l2_device.hpp"

namespace robot_vision
{

/// Read and write the value of the control that `query` describes. Both return 0 or the errno of the failed call. The
/// value has the driver's type, see control_values.hpp.
int readControl(V4l2Device& device, const v4l2_query_ext_ctrl& query, ControlValue& value);
int writeControl(V4l2Device& device, const v4l2_query_ext_ctrl& query, const ControlValue& value);

/// The exposure time in seconds; 0 if the device does not tell it.
double exposureTime(V4l2Device& device);

}  // namespace robot_vision
