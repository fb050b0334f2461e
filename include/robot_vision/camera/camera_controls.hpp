#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "robot_vision/camera/open_source.hpp"

namespace robot_vision
{

/// The value of a control: a boolean, a number (the number of the item for a menu), or a text (the item's for a menu).
using ControlValue = std::variant<bool, std::int64_t, std::string>;

std::string toText(const ControlValue& value);

enum class ControlKind
{
  kInteger,
  kBoolean,
  kMenu,
  kButton,    // has no value; setting it to any value presses it
  kBitmask,   // an unsigned number
  kText,      // minimum and maximum are those of its length
  kCompound,  // an array or structure, which cannot be set here
};

struct MenuItem
{
  std::int64_t number;
  std::string text;
};

/// A control of a camera, as the driver describes it.
struct CameraControl
{
  std::string name;  // as v4l2-ctl prints it, such as exposure_time_absolute
  std::uint32_t id = 0;
  ControlKind kind = ControlKind::kInteger;
  std::int64_t minimum = 0;
  std::int64_t maximum = 0;
  std::uint64_t step = 1;
  std::int64_t default_value = 0;
  std::vector<MenuItem> items;
  bool read_only = false;
  bool inactive = false;   // another control, such as its automatic mode, determines its value now
  bool has_value = false;  // false for buttons, compound controls, and where the driver does not tell the value
  ControlValue value;
};

/// The value to set a control to. The name may also be the one that usb_cam uses or that older or newer kernels have:
/// autoexposure, exposure_auto and auto_exposure are the same control, and true and false mean the same for each name.
struct ControlSetting
{
  std::string name;
  ControlValue value;
  bool is_implied = false;    // by another setting: nothing is missing where a camera has no such control
  std::string saved_as = {};  // where it is saved, as the user's file has it; empty: by the driver's name
};

/// A setting that failed, and one line that gives the reason.
struct RefusedSetting
{
  std::string name;
  std::string reason;
};

/// The control that a setting of this name is for, or null if there is none.
const CameraControl* findControl(const std::vector<CameraControl>& controls, const std::string& name);

/// Lists the controls in the driver's order. Throws SourceUnavailable if the device is gone, as setControls() does.
std::vector<CameraControl> listControls(V4l2Device& device);

/// Sets controls. Whatever the order of `settings`, the automatic modes are set before the controls that depend on
/// them. A setting that fails does not stop the others: those that failed are returned, each with a line that names the
/// device, the control, the value and what is possible.
std::vector<RefusedSetting> setControls(V4l2Device& device, const std::vector<ControlSetting>& settings);

/// Gives access to the controls of a device. While the device streams, the controls use the same open file, because
/// some drivers do not allow a second one; otherwise the device is opened for each use.
class ControlDevice
{
public:
  using Open = std::function<std::shared_ptr<V4l2Device>()>;
  /// The device that `params` name is looked up again each time it has to be opened.
  explicit ControlDevice(const CaptureParams& params);
  explicit ControlDevice(Open open) : open_(std::move(open)) {}

  /// From now on the controls are those of the device from which `source` streams.
  void follow(const FrameSource& source) { streaming_ = source.device(); }

  /// Throws SourceUnavailable if the device is not there.
  std::shared_ptr<V4l2Device> device() const;

private:
  Open open_;
  std::weak_ptr<V4l2Device> streaming_;
};

}  // namespace robot_vision
