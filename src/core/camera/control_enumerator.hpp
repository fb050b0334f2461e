#pragma once

#include <linux/videodev2.h>

#include <vector>

#include "v4l2_device.hpp"

namespace robot_vision
{

/// Enumerates the controls of a device in the order of their ids, including the headings of classes. Controls that the
/// driver fails to describe, which some webcams have, are skipped. Throws SourceUnavailable if the device is gone.
std::vector<v4l2_query_ext_ctrl> enumerateControls(V4l2Device& device);

}  // namespace robot_vision
