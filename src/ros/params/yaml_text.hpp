#pragma once

#include <string>
#include <utility>
#include <vector>

namespace robot_vision
{

using YamlValues = std::vector<std::pair<std::string, std::string>>;  // names and values as YAML text

/// Replaces a value at the top level of the text, keeping its comment, or adds it at the end.
std::string editYaml(const std::string& text, const std::string& name, const std::string& value);

/// Does so for the values of a map at the top level. The map is added if it is missing, and spread over several lines.
std::string editYamlMap(const std::string& text, const std::string& map, const YamlValues& values);

}  // namespace robot_vision
