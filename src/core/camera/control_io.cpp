#include "control_io.hpp"

#include <algorithm>

namespace robot_vision
{

ControlIo::ControlIo(const v4l2_query_ext_ctrl& query) : type_(query.type), text_(query.elem_size)
{
  control_.id = query.id;
  if (type_ != V4L2_CTRL_TYPE_STRING) return;
  control_.size = query.elem_size;
  control_.string = text_.data();
}

int ControlIo::get(V4l2Device& device, ControlValue& value)
{
  const int error = run(device, VIDIOC_G_EXT_CTRLS);
  if (error == 0) value = this->value();
  return error;
}

int ControlIo::set(V4l2Device& device, const ControlValue& value)
{
  put(value);
  return run(device, VIDIOC_S_EXT_CTRLS);
}

int ControlIo::run(V4l2Device& device, unsigned long request)
{
  v4l2_ext_controls call{};
  call.which = V4L2_CTRL_WHICH_CUR_VAL;
  call.count = 1;
  call.controls = &control_;
  return device.tryCall(request, &call);
}

void ControlIo::put(const ControlValue& value)
{
  if (const auto* text = std::get_if<std::string>(&value))
    std::copy(text->begin(), text->end(), text_.begin());
  else if (type_ == V4L2_CTRL_TYPE_INTEGER64)
    control_.value64 = std::get<std::int64_t>(value);
  else
    control_.value = static_cast<std::int32_t>(std::get<std::int64_t>(value));
}

ControlValue ControlIo::value() const
{
  switch (type_)
  {
    case V4L2_CTRL_TYPE_BOOLEAN:
      return control_.value != 0;
    case V4L2_CTRL_TYPE_STRING:
      return std::string(text_.data());
    case V4L2_CTRL_TYPE_INTEGER64:
      return std::int64_t{control_.value64};
    case V4L2_CTRL_TYPE_BITMASK:
      return std::int64_t{static_cast<std::uint32_t>(control_.value)};
    default:
      return std::int64_t{control_.value};
  }
}

}  // namespace robot_vision
