#pragma once

#include <dynamic_reconfigure/Config.h>

#include "robot_vision/filters/operations.hpp"

namespace robot_vision
{

/// All values of a dynamic_reconfigure message by their names.
ParamValues paramValues(const dynamic_reconfigure::Config& config);

}  // namespace robot_vision
