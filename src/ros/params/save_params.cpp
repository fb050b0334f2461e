#include "save_params.hpp"

#include <sys/stat.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "bounded_yaml.hpp"
#include "robot_vision/common/regular_file.hpp"
#include "robot_vision/common/replace_file.hpp"
#include "yaml_text.hpp"

namespace robot_vision
{
namespace
{

/// The shortest decimal that reads back as the same number and is recognised as a floating-point number.
std::string shortest(double value)
{
  const double magnitude = std::abs(value);
  const bool without_exponent = magnitude >= 1.0 && magnitude < 1e15;
  char text[32];
  for (int digits = without_exponent ? static_cast<int>(std::log10(magnitude)) + 1 : 1; digits <= 17; ++digits)
  {
    std::snprintf(text, sizeof(text), "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value) break;
  }
  std::string number = text;
  const std::size_t exponent = number.find('e');
  if (number.find('.') == std::string::npos)
    number.insert(std::min(exponent, number.size()), ".0");  // as YAML 1.1 requires
  return number;
}

std::string quoted(const std::string& value)
{
  YAML::Emitter text;
  text << YAML::DoubleQuoted << value;
  return text.c_str();
}

YamlValues toYaml(const dynamic_reconfigure::Config& config)
{
  YamlValues values;
  for (const auto& p : config.bools)
    values.emplace_back(p.name, p.value != 0 ? "true" : "false");
  for (const auto& p : config.ints)
    values.emplace_back(p.name, std::to_string(p.value));
  for (const auto& p : config.doubles)
    values.emplace_back(p.name, shortest(p.value));
  for (const auto& p : config.strs)
    values.emplace_back(p.name, quoted(p.value));
  return values;
}

/// Reads the file's text; empty if there is no such file.
std::string load(const std::string& path)
{
  struct stat status;
  return lstat(path.c_str(), &status) == 0 ? readFile(path, kMaxYamlText) : "";
}

/// Parses a YAML map.
YAML::Node parse(const std::string& path, const std::string& text)
{
  try
  {
    requireBoundedYaml(text);
    const YAML::Node root = YAML::Load(text);
    if (root.IsMap() || root.IsNull()) return root;
  }
  catch (const YAML::Exception& e)
  {
    throw std::runtime_error(path + ": not overwritten, for it is no valid YAML: " + e.what());
  }
  throw std::runtime_error(path + ": not overwritten, for it is no map of parameters");
}

/// True if `after` has the given values, and all other values of `before` unchanged.
bool hasOnlyChanged(const YAML::Node& after, const YAML::Node& before, const YamlValues& values)
{
  std::size_t expected = values.size();
  for (const auto& [name, value] : values)
    if (!after[name] || !after[name].IsScalar() || after[name].Scalar() != YAML::Load(value).Scalar()) return false;
  for (const auto& entry : before)
  {
    const auto& key = entry.first;
    const auto same = [&key](const auto& put) { return put.first == key.Scalar(); };
    if (std::any_of(values.begin(), values.end(), same)) continue;
    ++expected;
    if (!after[key.Scalar()] || YAML::Dump(after[key.Scalar()]) != YAML::Dump(entry.second)) return false;
  }
  return after.size() == expected;
}

/// The text with the given values. Throws if replacing the lines of the values does not give the intended map.
std::string editValues(const std::string& path, const std::string& text, const YamlValues& values)
{
  const YAML::Node before = parse(path, text);
  std::string edited = text;
  for (const auto& [name, value] : values)
    edited = editYaml(edited, name, value);
  if (hasOnlyChanged(parse(path, edited), before, values)) return edited;
  throw std::runtime_error(path + ": not overwritten, for its parameters are not one \"name: value\" in each line");
}

/// Like editValues(), for a map of parameters.
std::string editMap(const std::string& path, const std::string& text, const std::string& map, const YamlValues& values)
{
  const YAML::Node before = parse(path, text);
  const std::string edited = editYamlMap(text, map, values);
  const YAML::Node after = parse(path, edited);
  const bool others_unchanged = after.size() == before.size() + (before[map] ? 0 : 1);
  if (others_unchanged && after[map] && hasOnlyChanged(after[map], before[map] ? before[map] : YAML::Node(), values))
    return edited;
  throw std::runtime_error(path + ": not overwritten, for " + map + " is not one \"name: value\" in each line");
}

}  // namespace

std::string editParams(const std::string& path, const std::string& text, const dynamic_reconfigure::Config& config)
{
  return editValues(path, text, toYaml(config));
}

void saveParams(const std::string& path, const dynamic_reconfigure::Config& config, const ParamMaps& maps)
{
  std::string text = editParams(path, load(path), config);
  for (const auto& [name, config_of_map] : maps)
  {
    const YamlValues values = toYaml(config_of_map);
    if (!values.empty()) text = editMap(path, text, name, values);
  }
  replaceFile(path, text);
}

}  // namespace robot_vision
