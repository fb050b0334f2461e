#include <linux/videodev2.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "control_enumerator.hpp"
#include "control_io.hpp"
#include "control_values.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

/// A control's name as v4l2-ctl prints it: "Exposure, Auto" becomes exposure_auto.
std::string controlName(const std::string& title)
{
  std::string name;
  bool gap = false;
  for (const char c : title)
  {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) == 0)
    {
      gap = !name.empty();
      continue;
    }
    if (gap) name += '_';
    gap = false;
    name += static_cast<char>(std::tolower(letter));
  }
  return name;
}

ControlKind kindOf(const v4l2_query_ext_ctrl& query)
{
  switch (query.type)
  {
    case V4L2_CTRL_TYPE_BOOLEAN:
      return ControlKind::kBoolean;
    case V4L2_CTRL_TYPE_MENU:
    case V4L2_CTRL_TYPE_INTEGER_MENU:
      return ControlKind::kMenu;
    case V4L2_CTRL_TYPE_BUTTON:
      return ControlKind::kButton;
    case V4L2_CTRL_TYPE_BITMASK:
      return ControlKind::kBitmask;
    case V4L2_CTRL_TYPE_STRING:
      return ControlKind::kText;
    default:
      return (query.flags & V4L2_CTRL_FLAG_HAS_PAYLOAD) != 0 ? ControlKind::kCompound : ControlKind::kInteger;
  }
}

std::vector<MenuItem> itemsOf(V4l2Device& device, const v4l2_query_ext_ctrl& query)
{
  std::vector<MenuItem> items;
  const std::int64_t last = std::min<std::int64_t>(query.maximum, kMaxEntries - 1);
  for (std::int64_t i = std::max<std::int64_t>(query.minimum, 0); i <= last; ++i)
  {
    v4l2_querymenu item{};
    item.id = query.id;
    item.index = static_cast<std::uint32_t>(i);
    if (device.tryCall(VIDIOC_QUERYMENU, &item) != 0) continue;  // menus have gaps
    items.push_back({i, query.type == V4L2_CTRL_TYPE_MENU ? textOf(item.name) : std::to_string(item.value)});
  }
  return items;
}

CameraControl describe(V4l2Device& device, const v4l2_query_ext_ctrl& query)
{
  CameraControl control;
  control.name = controlName(textOf(query.name));
  control.id = query.id;
  control.kind = kindOf(query);
  control.minimum = query.minimum;
  control.maximum = query.maximum;
  control.step = query.step;
  control.default_value = query.default_value;
  control.read_only = (query.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0;
  control.inactive = (query.flags & V4L2_CTRL_FLAG_INACTIVE) != 0;
  if (control.kind == ControlKind::kBitmask)  // the driver gives them as signed 32-bit numbers
  {
    control.maximum &= std::numeric_limits<std::uint32_t>::max();
    control.default_value &= std::numeric_limits<std::uint32_t>::max();
  }
  if (control.kind == ControlKind::kMenu) control.items = itemsOf(device, query);
  const bool readable = control.kind != ControlKind::kButton && control.kind != ControlKind::kCompound;
  if (!readable || (query.flags & V4L2_CTRL_FLAG_WRITE_ONLY) != 0) return control;
  control.has_value = readControl(device, query, control.value) == 0;
  return control;
}

[[noreturn]] void refuse(V4l2Device& device, const char* call, int error)
{
  if (error == ENODEV) device.fail(call, error);
  throw std::invalid_argument(std::string("is refused by the driver: ") + std::strerror(error));
}

/// Queries the present description of a control: whether it is inactive depends on other controls.
v4l2_query_ext_ctrl query(V4l2Device& device, std::uint32_t id)
{
  v4l2_query_ext_ctrl query{};
  query.id = id;
  const int error = device.tryCall(VIDIOC_QUERY_EXT_CTRL, &query);
  if (error != 0) refuse(device, "VIDIOC_QUERY_EXT_CTRL", error);
  return query;
}

void setControl(V4l2Device& device, const CameraControl& control, const ControlValue& wanted)
{
  if (control.read_only) throw std::invalid_argument("is read-only");
  const ControlValue value = valueFor(control, wanted);
  const v4l2_query_ext_ctrl present = query(device, control.id);
  if ((present.flags & V4L2_CTRL_FLAG_INACTIVE) != 0)
    throw std::invalid_argument("is inactive: another control, such as its automatic mode, determines it now");
  const int error = writeControl(device, present, value);
  if (error == EBUSY) throw std::invalid_argument("cannot be changed while the camera streams");
  if (error != 0) refuse(device, "VIDIOC_S_EXT_CTRLS", error);
}

std::string joinedNames(const std::vector<CameraControl>& controls)
{
  if (controls.empty()) return "no controls";
  std::vector<std::string> all;
  for (const CameraControl& control : controls)
    all.push_back(control.name);
  return joined(all);
}

/// Makes a setting. Returns the error message, empty if there was no error.
std::string trySetting(V4l2Device& device, const std::vector<CameraControl>& controls, const ControlSetting& setting)
{
  const CameraControl* control = findControl(controls, setting.name);
  if (control == nullptr && setting.is_implied) return "";
  if (control == nullptr)
    return device.path() + ": there is no control " + setting.name + ", the camera has " + joinedNames(controls);
  try
  {
    setControl(device, *control, setting.value);
    return "";
  }
  catch (const std::invalid_argument& e)
  {
    return device.path() + ": control " + setting.name + " is " + toText(setting.value) + ", " + e.what();
  }
}

/// True for controls that may activate or deactivate others.
bool isSwitch(const std::vector<CameraControl>& controls, const ControlSetting& setting)
{
  const CameraControl* control = findControl(controls, setting.name);
  return control != nullptr && (control->kind == ControlKind::kBoolean || control->kind == ControlKind::kMenu);
}

}  // namespace

std::vector<CameraControl> listControls(V4l2Device& device)
{
  std::vector<CameraControl> controls;
  for (const v4l2_query_ext_ctrl& query : enumerateControls(device))
  {
    const bool heading = query.type == V4L2_CTRL_TYPE_CTRL_CLASS;
    if (!heading && (query.flags & V4L2_CTRL_FLAG_DISABLED) == 0) controls.push_back(describe(device, query));
  }
  return controls;
}

std::vector<RefusedSetting> setControls(V4l2Device& device, const std::vector<ControlSetting>& settings)
{
  const std::vector<CameraControl> controls = listControls(device);
  std::vector<ControlSetting> pending = settings;
  const auto is_switch = [&controls](const ControlSetting& setting) { return isSwitch(controls, setting); };
  std::stable_partition(pending.begin(), pending.end(), is_switch);

  // Switches may depend on each other. So settings that failed are tried again as long as another one succeeds.
  std::vector<RefusedSetting> refused;
  for (std::size_t last_count = pending.size() + 1; pending.size() < last_count;)
  {
    last_count = pending.size();
    refused.clear();
    std::vector<ControlSetting> left;
    for (const ControlSetting& setting : pending)
    {
      const std::string error = trySetting(device, controls, setting);
      if (error.empty()) continue;
      refused.push_back({setting.name, error});
      left.push_back(setting);
    }
    pending.swap(left);
  }
  return refused;
}

}  // namespace robot_vision
