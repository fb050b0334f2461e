#include "control_names.hpp"

#include <linux/videodev2.h>

#include <cctype>
#include <map>

namespace robot_vision
{

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

std::vector<std::uint32_t> idsOfControlName(const std::string& name)
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
  const auto found = kIds.find(name);
  return found == kIds.end() ? std::vector<std::uint32_t>() : found->second;
}

}  // namespace robot_vision
