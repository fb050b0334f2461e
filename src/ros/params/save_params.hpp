#pragma once

#include <dynamic_reconfigure/Config.h>

#include <map>
#include <string>

namespace robot_vision
{

/// The YAML text with the values of `config` in it, one "name: value" per line at its top level, and everything else as
/// it is: other keys, order, comments. Throws std::runtime_error naming `path`, where the text is from, and what is
/// wrong.
std::string editParams(const std::string& path, const std::string& text, const dynamic_reconfigure::Config& config);

using ParamMaps = std::map<std::string, dynamic_reconfigure::Config>;

/// The same for the file at `path`, which is replaced in one step or not at all; without one it is made. The values of
/// `maps` go into the maps of these names.
void saveParams(const std::string& path, const dynamic_reconfigure::Config& config, const ParamMaps& maps = {});

}  // namespace robot_vision
