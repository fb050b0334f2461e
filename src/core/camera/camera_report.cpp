#include "camera_report.hpp"

#include <vector>

#include "robot_vision/camera/camera_controls.hpp"
#include "v4l2_formats.hpp"
#include "v4l2_pixel_formats.hpp"

namespace robot_vision
{
namespace
{

std::string line(int depth, const std::string& text)
{
  return std::string(2 * static_cast<std::size_t>(depth), ' ') + text + "\n";
}

/// The rates may depend on the size: of a range of sizes, those of the largest are reported.
std::string reportSize(V4l2Device& device, std::uint32_t fourcc, const v4l2_frmsize_stepwise& range)
{
  const cv::Size largest(static_cast<int>(range.max_width), static_cast<int>(range.max_height));
  const std::vector<V4l2Periods> periods = offeredPeriods(device, fourcc, largest);
  return line(3, describeSizes({range}) + (periods.empty() ? "" : ": " + describeRates(periods)));
}

std::string reportOffer(V4l2Device& device, const V4l2Offer& offer)
{
  const V4l2Format* format = findV4l2Format(offer.fourcc);
  const std::string name = format == nullptr ? "not taken by camera_node" : format->name;
  const std::string fourcc = fourccText(offer.fourcc);
  std::string text =
      line(2, name + " (" + (offer.description.empty() ? fourcc : fourcc + ", " + offer.description) + ")");
  for (const v4l2_frmsize_stepwise& range : offer.sizes)
    text += reportSize(device, offer.fourcc, range);
  return text;
}

std::string kindText(const CameraControl& control)
{
  switch (control.kind)
  {
    case ControlKind::kInteger:
      return std::to_string(control.minimum) + " to " + std::to_string(control.maximum) +
             (control.step > 1 ? " in steps of " + std::to_string(control.step) : "");
    case ControlKind::kBoolean:
      return "true or false";
    case ControlKind::kMenu:
      return "one of those below";
    case ControlKind::kButton:
      return "button";
    case ControlKind::kBitmask:
      return "bits of " + std::to_string(control.maximum);
    case ControlKind::kText:
      return "text of " + std::to_string(control.minimum) + " to " + std::to_string(control.maximum) + " characters";
    case ControlKind::kCompound:
      break;
  }
  return "compound, cannot be set here";
}

std::string defaultText(const CameraControl& control)
{
  switch (control.kind)
  {
    case ControlKind::kBoolean:
      return std::string(", default ") + (control.default_value != 0 ? "true" : "false");
    case ControlKind::kInteger:
    case ControlKind::kMenu:
    case ControlKind::kBitmask:
      return ", default " + std::to_string(control.default_value);
    default:
      return "";
  }
}

std::string reportControl(const CameraControl& control)
{
  std::string text = control.name + ": " + kindText(control) + defaultText(control);
  if (control.has_value) text += ", is " + toText(control.value);
  if (control.read_only) text += ", read-only";
  if (control.inactive) text += ", inactive";
  text = line(2, text);
  for (const MenuItem& item : control.items)
    text += line(3, std::to_string(item.number) + ": " + item.text);
  return text;
}

}  // namespace

std::string reportNames(const V4l2Camera& camera)
{
  std::string text = line(0, camera.path + ": " + camera.card);
  if (!camera.driver.empty()) text += line(1, "driver: " + camera.driver);
  if (!camera.bus.empty()) text += line(1, "bus: " + camera.bus);
  if (!camera.serial.empty()) text += line(1, "serial: " + camera.serial);
  for (const std::string& link : camera.links)
    text += line(1, link);
  if (!camera.problem.empty()) text += line(1, camera.problem);
  return text;
}

CameraReport reportCamera(const V4l2Camera& camera, const V4l2System& system)
{
  const std::string names = reportNames(camera);
  if (!camera.problem.empty()) return {names, false};
  try
  {
    const auto device = system.open(camera.path);
    return {names + reportModes(*device) + reportControls(*device), true};
  }
  catch (const SourceUnavailable& e)
  {
    return {names + line(1, e.what()), false};
  }
}

std::string reportModes(V4l2Device& device)
{
  std::string text;
  for (const V4l2Offer& offer : offeredFormats(device))
    text += reportOffer(device, offer);
  return line(1, "formats, by their names in pixel_format:") +
         (text.empty() ? line(2, "the driver does not say") : text);
}

std::string reportControls(V4l2Device& device)
{
  std::string text;
  for (const CameraControl& control : listControls(device))
    text += reportControl(control);
  return line(1, "controls:") + (text.empty() ? line(2, "none") : text);
}

}  // namespace robot_vision
