#include "control_params.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "robot_vision/common/printable.hpp"
#include "ros/params/params.hpp"
#include "ros/params/unknown_params.hpp"

namespace robot_vision
{
namespace
{

using XmlRpc::XmlRpcValue;

constexpr const char* kUsbCamControls[] = {"brightness",   "contrast", "saturation",    "sharpness",
                                           "gain",         "focus",    "autofocus",     "auto_focus",
                                           "autoexposure", "exposure", "white_balance", "auto_white_balance"};

constexpr std::size_t kMaxNameLength = 100;  // bytes, of a control's name in a message

[[noreturn]] void refuse(const std::string& name, const XmlRpcValue& value, const std::string& expected)
{
  throw std::invalid_argument(shortened(name, kMaxNameLength) + " is " + valueText(value) + ", must be " + expected);
}

/// True if a double is a 64-bit integer. The range check also excludes infinities, which equal their rounded value.
bool isInteger(double value)
{
  constexpr double kEnd = 9223372036854775808.0;  // 2^63
  return value >= -kEnd && value < kEnd && value == std::nearbyint(value);
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
    case XmlRpcValue::TypeDouble:  // the parameter server stores integers beyond 32 bits as doubles
      if (isInteger(static_cast<double>(value))) return static_cast<std::int64_t>(static_cast<double>(value));
      break;
    default:
      break;
  }
  refuse(name, value, "an integer, true, false or a text");
}

/// Adds what usb_cam does with a focus: it switches the autofocus off unless that is asked for.
void addFocusMode(std::vector<ControlSetting>& settings)
{
  const auto has = [&](const char* name)
  {
    return std::any_of(settings.begin(), settings.end(),
                       [name](const ControlSetting& setting) { return setting.name == name; });
  };
  if (has("focus") && !has("autofocus") && !has("auto_focus"))
    settings.push_back({"autofocus", false, /*is_implied=*/true});
}

/// Reads a map of control names and values; the result is not valid() if there is no such parameter.
XmlRpcValue readMap(const ros::NodeHandle& pnh, const std::string& map)
{
  noteKnownParam(pnh, map);
  XmlRpcValue controls;
  if (!pnh.getParam(map, controls)) return {};
  if (controls.getType() != XmlRpcValue::TypeStruct) refuse(map, controls, "a map of controls' names and values");
  noteKnownParam(pnh, map, valueText(controls));
  return controls;
}

/// Adds the settings of usb_cam's map of controls, except those that its entry `ignore` lists.
void addIntrinsicControls(const ros::NodeHandle& pnh, std::vector<ControlSetting>& settings)
{
  XmlRpcValue controls = readMap(pnh, "intrinsic_controls");
  if (!controls.valid()) return;
  std::set<std::string> ignored = {"ignore"};
  if (controls.hasMember("ignore"))
  {
    XmlRpcValue& names = controls["ignore"];
    const char* expected = "a list of controls' names";
    if (names.getType() != XmlRpcValue::TypeArray) refuse("intrinsic_controls/ignore", names, expected);
    for (int i = 0; i < names.size(); ++i)
    {
      if (names[i].getType() != XmlRpcValue::TypeString) refuse("intrinsic_controls/ignore", names, expected);
      ignored.insert(static_cast<std::string>(names[i]));
    }
  }
  for (const auto& [name, value] : controls)
    if (!ignored.count(name)) settings.push_back({name, toControlValue("intrinsic_controls/" + name, value)});
}

}  // namespace

std::vector<ControlSetting> readControlSettings(const ros::NodeHandle& pnh)
{
  std::vector<ControlSetting> settings;
  for (const char* name : kUsbCamControls)
  {
    noteKnownParam(pnh, name);
    XmlRpcValue value;
    if (!pnh.getParam(name, value)) continue;
    const ControlSetting setting{name, toControlValue(name, value)};
    if (setting.value == ControlValue(std::int64_t{-1})) continue;
    settings.push_back(setting);
    noteKnownParam(pnh, name, valueText(value));
  }
  addFocusMode(settings);
  addIntrinsicControls(pnh, settings);
  XmlRpcValue controls = readMap(pnh, "controls");
  if (!controls.valid()) return settings;
  for (const auto& [name, value] : controls)
    settings.push_back({name, toControlValue("controls/" + name, value), /*is_implied=*/false, name});
  return settings;
}

}  // namespace robot_vision
