#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "frame_source.hpp"

namespace robot_vision
{

/// A boolean, a number (of a menu: its item's), or the text of a menu's item or of a text control.
using ControlValue = std::variant<bool, std::int64_t, std::string>;

std::string toText(const ControlValue& value);

enum class ControlKind
{
  kInteger,
  kBoolean,
  kMenu,
  kButton,    // has no value; any that is set presses it
  kBitmask,   // a number without sign
  kText,      // minimum and maximum are of its length
  kCompound,  // arrays and structures, which cannot be set here
};

struct MenuItem
{
  std::int64_t number;
  std::string text;
};

/// A control of a camera, as the driver describes it.
struct CameraControl
{
  std::string name;  // as v4l2-ctl prints it: exposure_time_absolute
  std::uint32_t id = 0;
  ControlKind kind = ControlKind::kInteger;
  std::int64_t minimum = 0;
  std::int64_t maximum = 0;
  std::uint64_t step = 1;
  std::int64_t default_value = 0;
  std::vector<MenuItem> items;
  bool read_only = false;
  bool inactive = false;   // another control, such as its automatic, rules it now
  bool has_value = false;  // buttons and compound controls have none, and of some the driver tells none
  ControlValue value;
};

/// What to set a control to. The name may also be one of usb_cam's, or one that older or newer kernels have: all of
/// autoexposure, exposure_auto and auto_exposure are the same control, and true and false mean the same for all.
struct ControlSetting
{
  std::string name;
  ControlValue value;
};

/// A setting that could not be made, and a line that says why.
struct RefusedSetting
{
  std::string name;
  std::string why;
};

/// The control that a setting of this name is for; null: there is none.
const CameraControl* findControl(const std::vector<CameraControl>& controls, const std::string& name);

/// The controls in the driver's order. Throws SourceUnavailable if the device is gone, as setControls() does.
std::vector<CameraControl> listControls(V4l2Device& device);

/// Sets controls, automatics before what they rule, whatever the order; the others also if some cannot be set.
/// Returns those, each with a line that names device, control, value and what is possible.
std::vector<RefusedSetting> setControls(V4l2Device& device, const std::vector<ControlSetting>& settings);

/// The way to the controls of a device: the opening that it streams from, as some drivers allow no second one; while
/// nothing streams, an opening of its own, which ends with the use of it.
class ControlDevice
{
public:
  using Open = std::function<std::shared_ptr<V4l2Device>()>;
  /// Finds the device that `params` name anew whenever it has to be opened.
  explicit ControlDevice(const CaptureParams& params);
  explicit ControlDevice(Open open) : open_(std::move(open)) {}

  /// From now on the controls are those of the device that `source` streams from.
  void follow(const FrameSource& source) { streaming_ = source.device(); }

  /// Throws SourceUnavailable if the device is not there.
  std::shared_ptr<V4l2Device> device() const;

private:
  Open open_;
  std::weak_ptr<V4l2Device> streaming_;
};

}  // namespace robot_vision
