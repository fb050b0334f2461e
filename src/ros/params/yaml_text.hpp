#pragma once

#include <string>
#include <utility>
#include <vector>

namespace robot_vision
{

using YamlValues = std::vector<std::pair<std::string, std::string>>;  // name and value as YAML text

/// The text with one value of its top level replaced, in its line and before its comment, or added at the end.
std::string editYaml(const std::string& text, const std::string& name, const std::string& value);

/// The same for the values of a map at its top level, which is added or written over several lines where it is not.
std::string editYamlMap(const std::string& text, const std::string& map, const YamlValues& values);

}  // namespace robot_vision
