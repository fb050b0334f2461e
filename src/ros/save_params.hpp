#pragma once

#include <dynamic_reconfigure/Config.h>

#include <string>

namespace robot_vision
{

/// Puts the values of `config` into the YAML file at `path`, one "name: value" per line at its top level, and leaves
/// everything else in it as it is: other keys, order, comments. The file is replaced in one step or not at all.
/// Throws std::runtime_error naming the path and what is wrong.
void saveParams(const std::string& path, const dynamic_reconfigure::Config& config);

}  // namespace robot_vision
