#include "control_messages.hpp"

#include <dynamic_reconfigure/config_tools.h>

#include <cmath>
#include <limits>

namespace robot_vision
{
namespace
{

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigTools;

bool fitsInt32(std::int64_t number)
{
  return number >= std::numeric_limits<std::int32_t>::min() && number <= std::numeric_limits<std::int32_t>::max();
}

bool fitsInt32(const CameraControl& control)
{
  return fitsInt32(control.minimum) && fitsInt32(control.maximum);
}

bool isSettable(const CameraControl& control)
{
  return !control.read_only && control.kind != ControlKind::kCompound;
}

bool isBoolean(const CameraControl& control)
{
  return control.kind == ControlKind::kBoolean || control.kind == ControlKind::kButton;
}

std::string typeOf(const CameraControl& control)
{
  if (isBoolean(control)) return "bool";
  if (control.kind == ControlKind::kText) return "str";
  return fitsInt32(control) ? "int" : "double";
}

void put(Config& config, const std::string& type, const std::string& name, std::int64_t number)
{
  if (type == "bool")
    ConfigTools::appendParameter(config, name, number != 0);
  else if (type == "str")
    ConfigTools::appendParameter(config, name, std::string());
  else if (type == "int")
    ConfigTools::appendParameter(config, name, static_cast<std::int32_t>(number));
  else
    ConfigTools::appendParameter(config, name, static_cast<double>(number));
}

void put(Config& config, const std::string& type, const std::string& name, const ControlValue& value)
{
  if (const auto* text = std::get_if<std::string>(&value))
    ConfigTools::appendParameter(config, name, *text);
  else if (const auto* truth = std::get_if<bool>(&value))
    ConfigTools::appendParameter(config, name, *truth);
  else
    put(config, type, name, std::get<std::int64_t>(value));
}

/// Text in quotes, escaped for clients that evaluate it as Python.
std::string quoted(const std::string& text)
{
  std::string safe = "'";
  for (const char c : text)
    if (c == '\'' || c == '\\')
      safe += std::string("\\") + c;
    else if (static_cast<unsigned char>(c) >= ' ')
      safe += c;
  return safe + "'";
}

std::string enumeration(const CameraControl& control)
{
  if (control.kind != ControlKind::kMenu) return "";
  std::string items;
  for (const MenuItem& item : control.items)
    items += "{'name': " + quoted(item.text) + ", 'type': 'int', 'value': " + std::to_string(item.number) +
             ", 'description': '', 'srcline': 0, 'srcfile': '', 'cconsttype': 'const int', 'ctype': 'int'}, ";
  return "{'enum_description': '', 'enum': [" + items + "]}";
}

dynamic_reconfigure::GroupState groupState()
{
  dynamic_reconfigure::GroupState group;
  group.name = "Default";
  group.state = true;
  return group;
}

}  // namespace

dynamic_reconfigure::ConfigDescription toDescription(const std::vector<CameraControl>& controls)
{
  dynamic_reconfigure::ConfigDescription description;
  description.groups.resize(1);
  description.groups.front().name = "Default";
  for (const CameraControl& control : controls)
  {
    if (!isSettable(control)) continue;
    dynamic_reconfigure::ParamDescription parameter;
    parameter.name = control.name;
    parameter.type = typeOf(control);
    parameter.edit_method = enumeration(control);
    description.groups.front().parameters.push_back(parameter);
    put(description.min, parameter.type, control.name, isBoolean(control) ? 0 : control.minimum);
    put(description.max, parameter.type, control.name, isBoolean(control) ? 1 : control.maximum);
    put(description.dflt, parameter.type, control.name, control.default_value);
  }
  for (Config* config : {&description.min, &description.max, &description.dflt})
    config->groups.push_back(groupState());
  return description;
}

Config toConfig(const std::vector<CameraControl>& controls)
{
  Config config;
  config.groups.push_back(groupState());
  for (const CameraControl& control : controls)
  {
    if (!isSettable(control)) continue;
    if (control.has_value)
      put(config, typeOf(control), control.name, control.value);
    else
      put(config, typeOf(control), control.name, control.default_value);
  }
  return config;
}

Config toConfig(const std::vector<ControlSetting>& settings)
{
  Config config;
  for (const ControlSetting& setting : settings)
  {
    const auto* number = std::get_if<std::int64_t>(&setting.value);
    put(config, number == nullptr || fitsInt32(*number) ? "int" : "double", setting.name, setting.value);
  }
  return config;
}

std::vector<ControlSetting> changes(const std::vector<CameraControl>& controls, const Config& values)
{
  std::vector<ControlSetting> settings;
  const auto add = [&](const std::string& name, const ControlValue& value)
  {
    const CameraControl* control = findControl(controls, name);
    const bool pressed = control != nullptr && control->kind == ControlKind::kButton;
    const bool same = control != nullptr && control->has_value && control->value == value;
    if (pressed ? value == ControlValue(true) : !same) settings.push_back({name, value});
  };
  for (const auto& p : values.bools)
    add(p.name, p.value != 0);
  for (const auto& p : values.ints)
    add(p.name, std::int64_t{p.value});
  for (const auto& p : values.doubles)
    add(p.name, static_cast<std::int64_t>(std::llround(p.value)));
  for (const auto& p : values.strs)
    add(p.name, p.value);
  return settings;
}

}  // namespace robot_vision
