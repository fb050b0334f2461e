#include "control_values.hpp"

#include <linux/videodev2.h>
#include <strings.h>

#include <array>
#include <stdexcept>

namespace robot_vision
{
namespace
{

/// The item of the exposure mode's menu that true (automatic) or false means. Most webcams have only two of the four.
std::int64_t exposureModeItem(const CameraControl& control, bool automatic)
{
  const auto wanted = automatic ? std::array{V4L2_EXPOSURE_APERTURE_PRIORITY, V4L2_EXPOSURE_AUTO}
                                : std::array{V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY};
  for (const auto number : wanted)
    for (const MenuItem& item : control.items)
      if (item.number == number) return number;
  throw std::invalid_argument(automatic ? "it has no automatic mode" : "it is always automatic");
}

std::string choices(const CameraControl& control)
{
  std::string text;
  for (const MenuItem& item : control.items)
    text += (text.empty() ? "" : ", ") + std::to_string(item.number) + " '" + item.text + "'";
  return text;
}

std::int64_t menuItemOf(const CameraControl& control, const ControlValue& value)
{
  const auto* truth = std::get_if<bool>(&value);
  if (truth != nullptr && control.id == V4L2_CID_EXPOSURE_AUTO) return exposureModeItem(control, *truth);
  const auto* number = std::get_if<std::int64_t>(&value);
  const auto* text = std::get_if<std::string>(&value);
  for (const MenuItem& item : control.items)
    if ((number != nullptr && item.number == *number) ||
        (text != nullptr && strcasecmp(item.text.c_str(), text->c_str()) == 0))
      return item.number;
  throw std::invalid_argument("must be one of " + choices(control));
}

std::int64_t numberOf(const CameraControl& control, const ControlValue& value)
{
  const auto* number = std::get_if<std::int64_t>(&value);
  if (number != nullptr && *number >= control.minimum && *number <= control.maximum) return *number;
  throw std::invalid_argument("must be an integer from " + std::to_string(control.minimum) + " to " +
                              std::to_string(control.maximum));
}

std::int64_t maskOf(const CameraControl& control, const ControlValue& value)
{
  const auto* bits = std::get_if<std::int64_t>(&value);
  if (bits != nullptr && (*bits & ~control.maximum) == 0) return *bits;
  throw std::invalid_argument("must be a number with no other bits than " + std::to_string(control.maximum));
}

std::int64_t booleanOf(const ControlValue& value)
{
  if (const auto* truth = std::get_if<bool>(&value)) return *truth ? 1 : 0;
  const auto* number = std::get_if<std::int64_t>(&value);
  if (number != nullptr && (*number == 0 || *number == 1)) return *number;
  throw std::invalid_argument("must be true or false");
}

std::string textOf(const CameraControl& control, const ControlValue& value)
{
  const auto* text = std::get_if<std::string>(&value);
  const auto length = text == nullptr ? -1 : static_cast<std::int64_t>(text->size());
  if (length >= control.minimum && length <= control.maximum) return *text;
  throw std::invalid_argument("must be a text of " + std::to_string(control.minimum) + " to " +
                              std::to_string(control.maximum) + " characters");
}

}  // namespace

std::string toText(const ControlValue& value)
{
  if (const auto* truth = std::get_if<bool>(&value)) return *truth ? "true" : "false";
  if (const auto* number = std::get_if<std::int64_t>(&value)) return std::to_string(*number);
  return "'" + std::get<std::string>(value) + "'";
}

ControlValue valueFor(const CameraControl& control, const ControlValue& value)
{
  switch (control.kind)
  {
    case ControlKind::kBoolean:
      return booleanOf(value);
    case ControlKind::kMenu:
      return menuItemOf(control, value);
    case ControlKind::kBitmask:
      return maskOf(control, value);
    case ControlKind::kButton:
      return std::int64_t{1};
    case ControlKind::kText:
      return textOf(control, value);
    case ControlKind::kCompound:
      throw std::invalid_argument("has more than one value, and cannot be set here");
    default:
      return numberOf(control, value);
  }
}

}  // namespace robot_vision
