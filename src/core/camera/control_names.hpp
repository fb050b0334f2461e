#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace robot_vision
{

/// A control's name as v4l2-ctl prints it: "Exposure, Auto" becomes exposure_auto.
std::string controlName(const std::string& title);

/// The ids of the controls that usb_cam or other kernels call by this name, the likeliest first; empty if the name is
/// unknown.
std::vector<std::uint32_t> idsOfControlName(const std::string& name);

}  // namespace robot_vision
