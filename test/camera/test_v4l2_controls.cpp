#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <limits>

#include "core/camera/v4l2_source.hpp"
#include "robot_vision/camera/camera_controls.hpp"
#include "support/fake_v4l2.hpp"

using namespace robot_vision;

namespace
{

std::int64_t number(std::int64_t value)
{
  return value;
}

/// A camera with the controls of a UVC webcam, and one of each other kind.
FakeCamera webcam(bool old_kernel = false)
{
  const auto is_automatic = [](const FakeCamera& camera)
  { return camera.control(V4L2_CID_EXPOSURE_AUTO).value != V4L2_EXPOSURE_MANUAL; };
  FakeCamera camera;
  camera.controls = {
      {V4L2_CID_USER_CLASS, V4L2_CTRL_TYPE_CTRL_CLASS, "User Controls", 0, 0, 0, {}, V4L2_CTRL_FLAG_READ_ONLY},
      {V4L2_CID_BRIGHTNESS, V4L2_CTRL_TYPE_INTEGER, "Brightness", 0, 255, 128},
      {V4L2_CID_AUTO_WHITE_BALANCE, V4L2_CTRL_TYPE_BOOLEAN,
       old_kernel ? "White Balance Temperature, Auto" : "White Balance, Automatic", 0, 1, 1},
      {V4L2_CID_POWER_LINE_FREQUENCY,
       V4L2_CTRL_TYPE_MENU,
       "Power Line Frequency",
       0,
       2,
       2,
       {{0, "Disabled"}, {1, "50 Hz"}, {2, "60 Hz"}}},
      {V4L2_CID_EXPOSURE_AUTO,
       V4L2_CTRL_TYPE_MENU,
       old_kernel ? "Exposure, Auto" : "Auto Exposure",
       0,
       3,
       3,
       {{1, "Manual Mode"}, {3, "Aperture Priority Mode"}}},
      {V4L2_CID_EXPOSURE_ABSOLUTE,
       V4L2_CTRL_TYPE_INTEGER,
       old_kernel ? "Exposure (Absolute)" : "Exposure Time, Absolute",
       3,
       2047,
       250,
       {},
       0,
       is_automatic},
      {V4L2_CID_IMAGE_STABILIZATION, V4L2_CTRL_TYPE_BUTTON, "Press", 0, 0, 0, {}, V4L2_CTRL_FLAG_WRITE_ONLY},
      {V4L2_CID_LINK_FREQ, V4L2_CTRL_TYPE_INTEGER_MENU, "Link Frequency", 0, 1, 0, {{0, "9000000000"}, {1, "-3"}}},
      {V4L2_CID_PIXEL_RATE, V4L2_CTRL_TYPE_INTEGER64, "Pixel Rate", 0, 1LL << 40, 1LL << 33},
      {V4L2_CID_TEST_PATTERN, V4L2_CTRL_TYPE_STRING, "Label", 1, 8, 0, {}, 0, nullptr, "front"},
      {V4L2_CID_DETECT_MD_MODE, V4L2_CTRL_TYPE_BITMASK, "Flags", 0, static_cast<std::int32_t>(0xFFFFFFFF), 5},
      {V4L2_CID_DETECT_MD_GLOBAL_THRESHOLD, V4L2_CTRL_TYPE_INTEGER, "Serial", 0, 9, 7, {}, V4L2_CTRL_FLAG_READ_ONLY},
      {V4L2_CID_DETECT_MD_THRESHOLD_GRID, V4L2_CTRL_TYPE_U16, "Grid", 0, 9, 0, {}, V4L2_CTRL_FLAG_HAS_PAYLOAD},
  };
  const auto by_id = [](const FakeCamera::Control& a, const FakeCamera::Control& b) { return a.id < b.id; };
  std::sort(camera.controls.begin(), camera.controls.end(), by_id);
  return camera;
}

using Lines = std::vector<std::string>;

/// Sets controls and returns the messages of those that failed.
Lines set(FakeCamera& camera, const std::vector<ControlSetting>& settings)
{
  Lines lines;
  for (const RefusedSetting& refused : setControls(*camera.plug(), settings))
    lines.push_back(refused.reason);
  return lines;
}

}  // namespace

TEST(V4l2Controls, areListedUnderTheirNames)
{
  FakeCamera camera = webcam();
  const std::vector<CameraControl> controls = listControls(*camera.plug());
  EXPECT_EQ(controls.size(), camera.controls.size() - 1);  // all but the heading of the class

  const CameraControl& brightness = *findControl(controls, "brightness");
  EXPECT_EQ(brightness.kind, ControlKind::kInteger);
  EXPECT_EQ(brightness.maximum, 255);
  EXPECT_EQ(brightness.default_value, 128);
  EXPECT_EQ(brightness.value, ControlValue(number(128)));

  const CameraControl& exposure = *findControl(controls, "auto_exposure");
  ASSERT_EQ(exposure.items.size(), 2U);  // the menu has gaps
  EXPECT_EQ(exposure.items[1].number, 3);
  EXPECT_EQ(exposure.items[1].text, "Aperture Priority Mode");
  EXPECT_TRUE(findControl(controls, "exposure_time_absolute")->inactive);

  EXPECT_EQ(findControl(controls, "white_balance_automatic")->value, ControlValue(true));
  EXPECT_EQ(findControl(controls, "link_frequency")->items[0].text, "9000000000");
  EXPECT_EQ(findControl(controls, "pixel_rate")->value, ControlValue(number(1LL << 33)));
  EXPECT_EQ(findControl(controls, "label")->value, ControlValue(std::string("front")));
  EXPECT_EQ(findControl(controls, "flags")->maximum, 0xFFFFFFFF);
  EXPECT_TRUE(findControl(controls, "serial")->read_only);
  EXPECT_FALSE(findControl(controls, "press")->has_value);
  EXPECT_EQ(findControl(controls, "grid")->kind, ControlKind::kCompound);
}

TEST(V4l2Controls, areAnEmptyListOnADeviceWithoutAny)
{
  FakeCamera camera;
  camera.faults[VIDIOC_QUERY_EXT_CTRL] = {ENOTTY, ENOTTY};
  EXPECT_TRUE(listControls(*camera.plug()).empty());
  EXPECT_EQ(set(camera, {{"gain", number(1)}}),
            Lines{"/dev/video0: there is no control gain, the camera has no controls"});
}

TEST(V4l2Controls, areListedAlthoughOneCannotBeDescribed)
{
  const std::vector<std::uint32_t> table[] = {
      {V4L2_CID_BRIGHTNESS},
      {V4L2_CID_AUTO_WHITE_BALANCE, V4L2_CID_POWER_LINE_FREQUENCY},
      {V4L2_CID_EXPOSURE_AUTO},
      {V4L2_CID_USER_CLASS, V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CID_DETECT_MD_THRESHOLD_GRID},
  };
  for (const auto& bad : table)
  {
    FakeCamera camera = webcam();
    for (const std::uint32_t id : bad)
      camera.control(id).query_error = EIO;
    const std::vector<CameraControl> controls = listControls(*camera.plug());
    for (const FakeCamera::Control& control : camera.controls)
    {
      const bool listed = std::any_of(controls.begin(), controls.end(),
                                      [&](const CameraControl& other) { return other.id == control.id; });
      EXPECT_EQ(listed, control.query_error == 0 && control.type != V4L2_CTRL_TYPE_CTRL_CLASS) << control.title;
    }
    camera.control(V4L2_CID_PIXEL_RATE).value = 0;
    EXPECT_EQ(set(camera, {{"pixel_rate", number(7)}}), Lines());
    EXPECT_EQ(camera.control(V4L2_CID_PIXEL_RATE).value, 7);
  }
}

TEST(V4l2Controls, areAnEmptyListOnADeviceThatFailsAltogether)
{
  FakeCamera camera = webcam();
  for (FakeCamera::Control& control : camera.controls)
    control.query_error = EIO;
  EXPECT_TRUE(listControls(*camera.plug()).empty());
}

TEST(V4l2Controls, useTheDeviceThatStreams)
{
  FakeCamera camera = webcam();
  camera.exclusive = true;
  const ControlDevice::Open open = [&camera] { return camera.plug(); };
  ControlDevice control_device(open);
  {
    const V4l2Source source(camera.plug(), CaptureParams());
    EXPECT_THROW(control_device.device(), SourceUnavailable);
    control_device.follow(source);
    EXPECT_EQ(listControls(*control_device.device()).size(), camera.controls.size() - 1);
    EXPECT_TRUE(setControls(*control_device.device(), {{"brightness", number(9)}}).empty());
  }
  EXPECT_EQ(camera.open_devices, 0);
  EXPECT_EQ(findControl(listControls(*control_device.device()), "brightness")->value, ControlValue(number(9)));
  EXPECT_EQ(camera.open_devices, 0);
}

TEST(V4l2Controls, areListedEvenIfTheDriverTellsNonsense)
{
  for (const auto& [minimum, maximum] : {std::pair<std::int64_t, std::int64_t>{0, 0xFFFFFFFF},
                                         {0, std::numeric_limits<std::int64_t>::max()},
                                         {std::numeric_limits<std::int64_t>::min(), 2}})
  {
    FakeCamera camera = webcam();
    camera.control(V4L2_CID_POWER_LINE_FREQUENCY).minimum = minimum;
    camera.control(V4L2_CID_POWER_LINE_FREQUENCY).maximum = maximum;
    const std::vector<CameraControl> controls = listControls(*camera.plug());
    EXPECT_EQ(findControl(controls, "power_line_frequency")->items.size(), 3U);
    EXPECT_LT(camera.calls[VIDIOC_QUERYMENU], 1100);
  }
}

TEST(V4l2Controls, areListedOnceIfTheDriverBeginsAgain)
{
  FakeCamera camera = webcam();
  const std::size_t all = listControls(*camera.plug()).size();
  camera.repeats_controls = true;
  EXPECT_EQ(listControls(*camera.plug()).size(), all);
}

TEST(V4l2Controls, takeValuesOfEveryKind)
{
  FakeCamera camera = webcam();
  EXPECT_EQ(set(camera, {{"brightness", number(7)},
                         {"white_balance_automatic", false},
                         {"power_line_frequency", std::string("50 hz")},
                         {"link_frequency", std::string("-3")},
                         {"pixel_rate", number(1LL << 34)},
                         {"label", std::string("rear")},
                         {"flags", number(0x80000001)},
                         {"press", true}}),
            Lines());
  EXPECT_EQ(camera.control(V4L2_CID_BRIGHTNESS).value, 7);
  EXPECT_EQ(camera.control(V4L2_CID_AUTO_WHITE_BALANCE).value, 0);
  EXPECT_EQ(camera.control(V4L2_CID_POWER_LINE_FREQUENCY).value, 1);
  EXPECT_EQ(camera.control(V4L2_CID_LINK_FREQ).value, 1);
  EXPECT_EQ(camera.control(V4L2_CID_PIXEL_RATE).value, 1LL << 34);
  EXPECT_EQ(camera.control(V4L2_CID_TEST_PATTERN).text, "rear");
  EXPECT_EQ(camera.control(V4L2_CID_IMAGE_STABILIZATION).value, 1);
  EXPECT_EQ(findControl(listControls(*camera.plug()), "flags")->value, ControlValue(number(0x80000001)));
}

TEST(V4l2Controls, areSetInTheOrderOfTheirDependencies)
{
  for (const bool old_kernel : {false, true})
  {
    FakeCamera camera = webcam(old_kernel);
    EXPECT_EQ(set(camera, {{"exposure_time_absolute", number(99)}, {"auto_exposure", number(1)}}), Lines());
    EXPECT_EQ(camera.control(V4L2_CID_EXPOSURE_ABSOLUTE).value, 99);
  }
}

/// Some drivers accept a value that an automatic mode then replaces at once.
TEST(V4l2Controls, areAlwaysSetAfterTheirAutomaticModes)
{
  FakeCamera camera = webcam();
  camera.control(V4L2_CID_EXPOSURE_ABSOLUTE).inactive = nullptr;
  EXPECT_EQ(set(camera, {{"exposure_time_absolute", number(99)}, {"auto_exposure", number(1)}}), Lines());
  EXPECT_EQ(camera.controls_set, (std::vector<std::uint32_t>{V4L2_CID_EXPOSURE_AUTO, V4L2_CID_EXPOSURE_ABSOLUTE}));
}

TEST(V4l2Controls, areTriedAgainIfTheyDependOnEachOther)
{
  FakeCamera camera = webcam();
  camera.control(V4L2_CID_POWER_LINE_FREQUENCY).inactive = [](const FakeCamera& of)
  { return of.control(V4L2_CID_EXPOSURE_AUTO).value != V4L2_EXPOSURE_MANUAL; };
  EXPECT_EQ(set(camera, {{"power_line_frequency", number(0)}, {"auto_exposure", number(1)}}), Lines());
  EXPECT_EQ(camera.control(V4L2_CID_POWER_LINE_FREQUENCY).value, 0);
}

TEST(V4l2Controls, areKnownByTheNamesOfUsbCamAndAllKernels)
{
  for (const bool old_kernel : {false, true})
  {
    for (const std::string name : {"autoexposure", "exposure_auto", "auto_exposure"})
    {
      FakeCamera camera = webcam(old_kernel);
      EXPECT_EQ(set(camera, {{name, false}}), Lines());
      EXPECT_EQ(camera.control(V4L2_CID_EXPOSURE_AUTO).value, V4L2_EXPOSURE_MANUAL) << name;
      for (const std::string time : {"exposure", "exposure_absolute", "exposure_time_absolute"})
      {
        EXPECT_EQ(set(camera, {{time, number(77)}}), Lines());
        EXPECT_EQ(camera.control(V4L2_CID_EXPOSURE_ABSOLUTE).value, 77) << time;
        camera.control(V4L2_CID_EXPOSURE_ABSOLUTE).value = 0;
      }
      EXPECT_EQ(set(camera, {{name, true}}), Lines());
      EXPECT_EQ(camera.control(V4L2_CID_EXPOSURE_AUTO).value, V4L2_EXPOSURE_APERTURE_PRIORITY) << name;
    }
    for (const std::string name : {"auto_white_balance", "white_balance_temperature_auto", "white_balance_automatic"})
    {
      FakeCamera camera = webcam(old_kernel);
      EXPECT_EQ(set(camera, {{name, number(0)}}), Lines());
      EXPECT_EQ(camera.control(V4L2_CID_AUTO_WHITE_BALANCE).value, 0) << name;
    }
  }
}

TEST(V4l2Controls, areSetAlthoughOthersFail)
{
  FakeCamera camera = webcam();
  const std::vector<std::pair<ControlSetting, std::string>> table = {
      {{"brightness", number(256)}, "control brightness is 256, must be an integer from 0 to 255"},
      {{"brightness", std::string("high")}, "control brightness is 'high', must be an integer from 0 to 255"},
      {{"brightness", true}, "control brightness is true, must be an integer from 0 to 255"},
      {{"white_balance_automatic", number(2)}, "control white_balance_automatic is 2, must be true or false"},
      {{"power_line_frequency", number(3)},
       "control power_line_frequency is 3, must be one of 0 'Disabled', 1 '50 Hz', 2 '60 Hz'"},
      {{"power_line_frequency", false},
       "control power_line_frequency is false, must be one of 0 'Disabled', 1 '50 Hz', 2 '60 Hz'"},
      {{"flags", number(1LL << 32)},
       "control flags is 4294967296, must be a number with no other bits than 4294967295"},
      {{"label", std::string("much too long")},
       "control label is 'much too long', must be a text of 1 to 8 characters"},
      {{"serial", number(1)}, "control serial is 1, is read-only"},
      {{"grid", number(1)}, "control grid is 1, has more than one value, and cannot be set here"},
      {{"exposure", number(100)},
       "control exposure is 100, is inactive: another control, such as its automatic mode, determines it now"},
  };
  for (const auto& [setting, complaint] : table)
  {
    camera.control(V4L2_CID_LINK_FREQ).value = 0;
    EXPECT_EQ(set(camera, {setting, {"link_frequency", number(1)}}), Lines{"/dev/video0: " + complaint});
    EXPECT_EQ(camera.control(V4L2_CID_LINK_FREQ).value, 1);
  }
  const Lines unknown = set(camera, {{"brightnes", number(1)}});
  ASSERT_EQ(unknown.size(), 1U);
  EXPECT_EQ(unknown[0].find("/dev/video0: there is no control brightnes, the camera has brightness, "), 0U)
      << unknown[0];
}

TEST(V4l2Controls, areNotMissedIfAnotherSettingImpliesThem)
{
  FakeCamera camera = webcam();
  EXPECT_EQ(set(camera, {{"autofocus", false, /*is_implied=*/true}}), Lines());
  EXPECT_EQ(set(camera, {{"auto_white_balance", false, /*is_implied=*/true}}), Lines());
  EXPECT_EQ(camera.control(V4L2_CID_AUTO_WHITE_BALANCE).value, 0);
  EXPECT_EQ(set(camera, {{"brightness", number(256), /*is_implied=*/true}}).size(), 1U);
}

TEST(V4l2Controls, areNamedIfTheDriverRefusesThem)
{
  FakeCamera camera = webcam();
  camera.faults[VIDIOC_S_EXT_CTRLS] = {EBUSY};
  EXPECT_EQ(set(camera, {{"brightness", number(1)}}),
            Lines{"/dev/video0: control brightness is 1, cannot be changed while the camera streams"});
  camera.faults[VIDIOC_S_EXT_CTRLS] = {EIO};
  EXPECT_EQ(set(camera, {{"brightness", number(1)}}),
            Lines{"/dev/video0: control brightness is 1, is refused by the driver: Input/output error"});
  camera.faults[VIDIOC_QUERY_EXT_CTRL].assign(camera.controls.size() + 1, 0);  // listing the controls succeeds
  for (const int error : {EIO, 0, EIO})  // the first setting fails, the second succeeds, and the first fails again
    camera.faults[VIDIOC_QUERY_EXT_CTRL].push_back(error);
  EXPECT_EQ(set(camera, {{"brightness", number(1)}, {"pixel_rate", number(1)}}),
            Lines{"/dev/video0: control brightness is 1, is refused by the driver: Input/output error"});
  EXPECT_EQ(camera.control(V4L2_CID_PIXEL_RATE).value, 1);
  camera.faults[VIDIOC_S_EXT_CTRLS] = {ENODEV};
  EXPECT_THROW(set(camera, {{"brightness", number(1)}}), SourceUnavailable);
  EXPECT_EQ(camera.open_devices, 0);
}
