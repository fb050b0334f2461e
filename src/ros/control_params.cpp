#include "control_params.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "unknown_params.hpp"

namespace robot_vision
{
namespace
{

using XmlRpc::XmlRpcValue;

constexpr const char* kUsbCams[] = {"brightness",   "contrast", "saturation",    "sharpness",
                                    "gain",         "focus",    "autofocus",     "auto_focus",
                                    "autoexposure", "exposure", "white_balance", "auto_white_balance"};

[[noreturn]] void refuse(const std::string& name, const XmlRpcValue& value, const std::string& expected)
{
  std::ostringstream text;
  text << value;
  throw std::invalid_argument(name + " is " + text.str() + ", must be " + expected);
}

ControlValue toControlValue(const std::string& name, XmlRpcValue value)
{
  switch (value.getType())
  {
    case XmlRpcValue::TypeBoolean:
      return static_cast<bool>(value);
    case XmlRpcValue::TypeInt:
      return std::int64_t{static_cast<int>(value)};
    case XmlRpcValue::TypeString:
      return static_cast<std::string>(value);
    case XmlRpcValue::TypeDouble:  // the parameter server has no larger integers
      if (static_cast<double>(value) == std::nearbyint(static_cast<double>(value)))
        return static_cast<std::int64_t>(static_cast<double>(value));
      break;
    default:
      break;
  }
  refuse(name, value, "an integer, true, false or a text");
}

}  // namespace

std::vector<ControlSetting> readControlSettings(const ros::NodeHandle& pnh)
{
  std::vector<ControlSetting> settings;
  for (const char* name : kUsbCams)
  {
    noteKnownParam(pnh, name);
    XmlRpcValue value;
    if (!pnh.getParam(name, value)) continue;
    const ControlSetting setting{name, toControlValue(name, value)};
    if (setting.value != ControlValue(std::int64_t{-1})) settings.push_back(setting);
  }
  noteKnownParam(pnh, "controls");
  XmlRpcValue controls;
  if (!pnh.getParam("controls", controls)) return settings;
  if (controls.getType() != XmlRpcValue::TypeStruct)
    refuse("controls", controls, "a map of controls' names and values");
  for (const auto& [name, value] : controls)
    settings.push_back({name, toControlValue("controls/" + name, value)});
  return settings;
}

}  // namespace robot_vision
