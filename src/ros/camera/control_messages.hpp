#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>

#include <vector>

#include "robot_vision/camera/camera_controls.hpp"

namespace robot_vision
{

/// Describes the controls that can be set to dynamic_reconfigure's clients: numbers beyond 32 bits are doubles, menus
/// are enumerations of the numbers of their items, and buttons are booleans.
dynamic_reconfigure::ConfigDescription toDescription(const std::vector<CameraControl>& controls);

/// The present values of these controls.
dynamic_reconfigure::Config toConfig(const std::vector<CameraControl>& controls);

dynamic_reconfigure::Config toConfig(const std::vector<ControlSetting>& settings);

/// The values that differ from the present ones, also those of unknown controls.
std::vector<ControlSetting> changes(const std::vector<CameraControl>& controls,
                                    const dynamic_reconfigure::Config& values);

}  // namespace robot_vision
