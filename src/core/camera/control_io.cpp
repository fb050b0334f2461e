#include "control_io.hpp"

#include <algorithm>
#include <vector>

namespace robot_vision
{
namespace
{

constexpr double kExposureUnit = 1e-4;  // s, the unit of V4L2_CID_EXPOSURE_ABSOLUTE

/// The control for a call. The value of a text is in `text`, which must outlive it.
v4l2_ext_control controlOf(const v4l2_query_ext_ctrl& query, std::vector<char>& text)
{
  v4l2_ext_control control{};
  control.id = query.id;
  if (query.type != V4L2_CTRL_TYPE_STRING) return control;
  text.resize(query.elem_size);
  control.size = query.elem_size;
  control.string = text.data();
  return control;
}

int call(V4l2Device& device, unsigned long request, v4l2_ext_control& control)
{
  v4l2_ext_controls call{};
  call.which = V4L2_CTRL_WHICH_CUR_VAL;
  call.count = 1;
  call.controls = &control;
  return device.tryCall(request, &call);
}

ControlValue valueOf(const v4l2_ext_control& control, std::uint32_t type)
{
  switch (type)
  {
    case V4L2_CTRL_TYPE_BOOLEAN:
      return control.value != 0;
    case V4L2_CTRL_TYPE_STRING:
      return std::string(control.string);
    case V4L2_CTRL_TYPE_INTEGER64:
      return std::int64_t{control.value64};
    case V4L2_CTRL_TYPE_BITMASK:
      return std::int64_t{static_cast<std::uint32_t>(control.value)};
    default:
      return std::int64_t{control.value};
  }
}

}  // namespace

int readControl(V4l2Device& device, const v4l2_query_ext_ctrl& query, ControlValue& value)
{
  std::vector<char> text;
  v4l2_ext_control control = controlOf(query, text);
  const int error = call(device, VIDIOC_G_EXT_CTRLS, control);
  if (error == 0) value = valueOf(control, query.type);
  return error;
}

int writeControl(V4l2Device& device, const v4l2_query_ext_ctrl& query, const ControlValue& value)
{
  std::vector<char> text;
  v4l2_ext_control control = controlOf(query, text);
  if (const auto* wanted = std::get_if<std::string>(&value))
    std::copy(wanted->begin(), wanted->end(), text.begin());
  else if (query.type == V4L2_CTRL_TYPE_INTEGER64)
    control.value64 = std::get<std::int64_t>(value);
  else
    control.value = static_cast<std::int32_t>(std::get<std::int64_t>(value));
  return call(device, VIDIOC_S_EXT_CTRLS, control);
}

double exposureTime(V4l2Device& device)
{
  v4l2_query_ext_ctrl exposure{};
  exposure.id = V4L2_CID_EXPOSURE_ABSOLUTE;
  exposure.type = V4L2_CTRL_TYPE_INTEGER;
  ControlValue value;
  return readControl(device, exposure, value) == 0 ? std::get<std::int64_t>(value) * kExposureUnit : 0.0;
}

}  // namespace robot_vision
