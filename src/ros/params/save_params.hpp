#pragma once

#include <dynamic_reconfigure/Config.h>

#include <map>
#include <string>

namespace robot_vision
{

/// Puts the values of `config` into the YAML text, one "name: value" per line at its top level. Everything else stays
/// as it is: other keys, order, comments. Throws std::runtime_error naming the error and `path`, the file of the text.
std::string editParams(const std::string& path, const std::string& text, const dynamic_reconfigure::Config& config);

using ParamMaps = std::map<std::string, dynamic_reconfigure::Config>;

/// Does the same for the file at `path`, which is replaced in one step or not at all, and made if it does not exist.
/// The values of `maps` go into the file's maps of these names.
void saveParams(const std::string& path, const dynamic_reconfigure::Config& config, const ParamMaps& maps = {});

}  // namespace robot_vision
