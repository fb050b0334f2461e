#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>

#include <vector>

#include "robot_vision/camera/camera_controls.hpp"

namespace robot_vision
{

/// The controls that can be set, as dynamic_reconfigure's clients want them: numbers beyond 32 bits are doubles, menus
/// enumerations of their items' numbers, buttons booleans.
dynamic_reconfigure::ConfigDescription toDescription(const std::vector<CameraControl>& controls);

/// Their present values.
dynamic_reconfigure::Config toConfig(const std::vector<CameraControl>& controls);

dynamic_reconfigure::Config toConfig(const std::vector<ControlSetting>& settings);

/// Those of the values that differ from the present ones, also of controls that are not there.
std::vector<ControlSetting> changes(const std::vector<CameraControl>& controls,
                                    const dynamic_reconfigure::Config& values);

}  // namespace robot_vision
