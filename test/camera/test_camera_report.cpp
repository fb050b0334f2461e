#include <gtest/gtest.h>

#include "core/camera/camera_report.hpp"
#include "support/fake_v4l2.hpp"

using namespace robot_vision;

TEST(CameraReport, tellsTheNames)
{
  const V4l2Camera camera = {"/dev/video0", "C920", "uvcvideo", "usb-1", "1A2B", {"/dev/v4l/by-id/c920"}, ""};
  EXPECT_EQ(reportNames(camera),
            "/dev/video0: C920\n"
            "  driver: uvcvideo\n"
            "  bus: usb-1\n"
            "  serial: 1A2B\n"
            "  /dev/v4l/by-id/c920\n");
  EXPECT_EQ(reportNames({"/dev/video0", "C920", "", "", "", {}, "cannot be opened"}),
            "/dev/video0: C920\n"
            "  cannot be opened\n");
}

TEST(CameraReport, tellsFormatsSizesAndRates)
{
  FakeCamera camera;
  camera.formats = {{V4L2_PIX_FMT_YUYV, 16, {{640, 480, {30.0, 7.5}}, {320, 240, {60.0}}}},
                    {V4L2_PIX_FMT_HEVC, 8, {{640, 480, {30.0}}}},
                    {V4L2_PIX_FMT_GREY, 8, {{1920, 1080, {30.0}}}, {32, 1920, 16, 24, 1080, 8}}};
  EXPECT_EQ(reportModes(*camera.plug()),
            "  formats, by their names in pixel_format:\n"
            "    yuyv (YUYV)\n"
            "      640x480: 30, 7.5 Hz\n"
            "      320x240: 60 Hz\n"
            "    not taken by camera_node (HEVC)\n"
            "      640x480: 30 Hz\n"
            "    grey (GREY)\n"
            "      32x24 to 1920x1080 in steps of 16x8: 30 Hz\n");
  camera.enumerates = false;
  EXPECT_EQ(reportModes(*camera.plug()),
            "  formats, by their names in pixel_format:\n"
            "    the driver does not say\n");
}

TEST(CameraReport, tellsTheControls)
{
  FakeCamera camera;
  EXPECT_EQ(reportControls(*camera.plug()), "  controls:\n    none\n");
  camera.controls = {
      {V4L2_CID_BRIGHTNESS, V4L2_CTRL_TYPE_INTEGER, "Brightness", 0, 255, 130},
      {V4L2_CID_AUTO_WHITE_BALANCE, V4L2_CTRL_TYPE_BOOLEAN, "White Balance, Automatic", 0, 1, 1},
      {V4L2_CID_POWER_LINE_FREQUENCY,
       V4L2_CTRL_TYPE_MENU,
       "Power Line Frequency",
       0,
       2,
       1,
       {{0, "Disabled"}, {1, "50 Hz"}, {2, "60 Hz"}}},
      {V4L2_CID_SHARPNESS,
       V4L2_CTRL_TYPE_INTEGER,
       "Sharpness",
       1,
       5,
       3,
       {},
       V4L2_CTRL_FLAG_READ_ONLY | V4L2_CTRL_FLAG_INACTIVE},
  };
  EXPECT_EQ(reportControls(*camera.plug()),
            "  controls:\n"
            "    brightness: 0 to 255, default 130, is 130\n"
            "    white_balance_automatic: true or false, default true, is true\n"
            "    power_line_frequency: one of those below, default 1, is 1\n"
            "      0: Disabled\n"
            "      1: 50 Hz\n"
            "      2: 60 Hz\n"
            "    sharpness: 1 to 5, default 3, is 3, read-only, inactive\n");
}
