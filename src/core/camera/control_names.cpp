#include <linux/videodev2.h>

#include <map>

#include "robot_vision/camera/camera_controls.hpp"

namespace robot_vision
{

const CameraControl* findControl(const std::vector<CameraControl>& controls, const std::string& name)
{
  // Linux renamed these controls between 5.15 and 6.0. The last name of each group is usb_cam's parameter.
  static const std::map<std::string, std::vector<std::uint32_t>> kIds = {
      {"exposure_auto", {V4L2_CID_EXPOSURE_AUTO}},
      {"auto_exposure", {V4L2_CID_EXPOSURE_AUTO}},
      {"autoexposure", {V4L2_CID_EXPOSURE_AUTO}},
      {"exposure_absolute", {V4L2_CID_EXPOSURE_ABSOLUTE}},
      {"exposure_time_absolute", {V4L2_CID_EXPOSURE_ABSOLUTE}},
      {"exposure", {V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CID_EXPOSURE}},
      {"exposure_auto_priority", {V4L2_CID_EXPOSURE_AUTO_PRIORITY}},
      {"exposure_dynamic_framerate", {V4L2_CID_EXPOSURE_AUTO_PRIORITY}},
      {"white_balance_temperature_auto", {V4L2_CID_AUTO_WHITE_BALANCE}},
      {"white_balance_automatic", {V4L2_CID_AUTO_WHITE_BALANCE}},
      {"auto_white_balance", {V4L2_CID_AUTO_WHITE_BALANCE}},
      {"white_balance_temperature", {V4L2_CID_WHITE_BALANCE_TEMPERATURE}},
      {"white_balance", {V4L2_CID_WHITE_BALANCE_TEMPERATURE}},
      {"focus_auto", {V4L2_CID_FOCUS_AUTO}},
      {"focus_automatic_continuous", {V4L2_CID_FOCUS_AUTO}},
      {"autofocus", {V4L2_CID_FOCUS_AUTO}},
      {"auto_focus", {V4L2_CID_FOCUS_AUTO}},
      {"focus_absolute", {V4L2_CID_FOCUS_ABSOLUTE}},
      {"focus", {V4L2_CID_FOCUS_ABSOLUTE}},
      {"hue_auto", {V4L2_CID_HUE_AUTO}},
      {"hue_automatic", {V4L2_CID_HUE_AUTO}},
      {"gain_auto", {V4L2_CID_AUTOGAIN}},
      {"gain_automatic", {V4L2_CID_AUTOGAIN}},
      {"gain", {V4L2_CID_GAIN, V4L2_CID_ANALOGUE_GAIN}},
  };
  for (const CameraControl& control : controls)
    if (control.name == name) return &control;
  const auto ids = kIds.find(name);
  if (ids == kIds.end()) return nullptr;
  for (const std::uint32_t id : ids->second)
    for (const CameraControl& control : controls)
      if (control.id == id) return &control;
  return nullptr;
}

}  // namespace robot_vision
