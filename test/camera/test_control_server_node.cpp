#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>

#include "core/camera/v4l2_source.hpp"
#include "ros/camera/control_params.hpp"
#include "ros/camera/control_server.hpp"
#include "support/fake_v4l2.hpp"
#include "support/run_tests.hpp"

using namespace robot_vision;

namespace
{

/// A camera whose driver does not let it be opened twice.
FakeCamera webcam()
{
  FakeCamera camera;
  camera.exclusive = true;
  camera.controls = {{V4L2_CID_BRIGHTNESS, V4L2_CTRL_TYPE_INTEGER, "Brightness", 0, 255, 128}};
  return camera;
}

dynamic_reconfigure::Config brightness(int value)
{
  dynamic_reconfigure::Config config;
  config.ints.resize(1);
  config.ints[0].name = "brightness";
  config.ints[0].value = value;
  return config;
}

/// Changes the brightness by the service and returns the value that the service answers.
int setBrightness(int value)
{
  dynamic_reconfigure::Reconfigure call;
  call.request.config = brightness(value);
  EXPECT_TRUE(ros::service::call(ros::NodeHandle("~").resolveName("controls/set_parameters"), call));
  return call.response.config.ints.empty() ? -1 : call.response.config.ints[0].value;
}

}  // namespace

TEST(ControlSettings, takeUsbCamsParametersThenItsMapThenOurs)
{
  const ros::NodeHandle nh("~settings");
  nh.setParam("brightness", 5);
  nh.setParam("gain", -1);
  nh.setParam("intrinsic_controls/exposure_auto", 3);
  nh.setParam("intrinsic_controls/focus_auto", true);
  nh.setParam("intrinsic_controls/contrast", 7);
  nh.setParam("intrinsic_controls/ignore", std::vector<std::string>{"contrast", "sharpness"});
  nh.setParam("controls/gamma", 100);
  const std::vector<ControlSetting> settings = readControlSettings(nh);
  const std::vector<std::pair<std::string, ControlValue>> expected = {{"brightness", std::int64_t{5}},
                                                                      {"exposure_auto", std::int64_t{3}},
                                                                      {"focus_auto", true},
                                                                      {"gamma", std::int64_t{100}}};
  ASSERT_EQ(settings.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
  {
    EXPECT_EQ(settings[i].name, expected[i].first);
    EXPECT_TRUE(settings[i].value == expected[i].second) << expected[i].first;
  }
}

TEST(ControlSettings, switchTheAutofocusOffForAFocusAsUsbCamDoes)
{
  const ros::NodeHandle nh("~focus");
  const auto autofocus = [&nh]
  {
    std::string values;
    for (const ControlSetting& setting : readControlSettings(nh))
      if (setting.name == "autofocus") values += toText(setting.value) + (setting.is_implied ? ", implied " : " ");
    return values;
  };
  EXPECT_EQ(autofocus(), "");
  nh.setParam("focus", -1);
  EXPECT_EQ(autofocus(), "");
  nh.setParam("focus", 40);
  EXPECT_EQ(autofocus(), "false, implied ");
  nh.setParam("autofocus", true);
  EXPECT_EQ(autofocus(), "true ");
}

TEST(ControlServer, opensTheDeviceOnceForEachChange)
{
  FakeCamera camera = webcam();
  ControlServer server(ros::NodeHandle("~"), ControlDevice([&camera] { return camera.plug(); }), {});
  EXPECT_EQ(setBrightness(9), 9);
  EXPECT_EQ(camera.openings, 1);
  EXPECT_EQ(camera.open_devices, 0);
}

TEST(ControlServer, setsWhatTheDriverFailsToDescribeAtFirst)
{
  FakeCamera camera = webcam();
  ControlServer server(ros::NodeHandle("~"), ControlDevice([&camera] { return camera.plug(); }), {});
  EXPECT_EQ(setBrightness(3), 3);
  camera.faults[VIDIOC_QUERY_EXT_CTRL] = {EIO, EIO};  // for the next one, and for it by its number
  EXPECT_EQ(setBrightness(9), 9);
  EXPECT_EQ(camera.control(V4L2_CID_BRIGHTNESS).value, 9);
}

TEST(ControlServer, usesTheStreamingDeviceAndRestoresSettings)
{
  FakeCamera camera = webcam();
  ControlServer server(ros::NodeHandle("~"), ControlDevice([&camera] { return camera.plug(); }), {});
  const auto open_source = [&camera] { return std::make_unique<V4l2Source>(camera.plug(), CaptureParams()); };
  EXPECT_EQ(setBrightness(9), 9);
  camera.replug();
  const auto source = server.open(open_source);
  EXPECT_EQ(camera.control(V4L2_CID_BRIGHTNESS).value, 9);
  EXPECT_EQ(setBrightness(7), 7);
  EXPECT_EQ(camera.openings, 2);
}

TEST(ControlServer, savesWhatIsImpliedOnlyIfTheCameraHasIt)
{
  FakeCamera camera = webcam();
  const std::vector<ControlSetting> given = {{"focus", std::int64_t{40}}, {"autofocus", false, /*is_implied=*/true}};
  ControlServer server(ros::NodeHandle("~"), ControlDevice([&camera] { return camera.plug(); }), given);
  const auto open_source = [&camera] { return std::make_unique<V4l2Source>(camera.plug(), CaptureParams()); };
  server.open(open_source);
  EXPECT_EQ(server.settings().ints.size(), 1U);
  EXPECT_TRUE(server.settings().bools.empty());
  camera.controls.push_back({V4L2_CID_FOCUS_ABSOLUTE, V4L2_CTRL_TYPE_INTEGER, "Focus, Absolute", 0, 255, 0});
  camera.controls.push_back({V4L2_CID_FOCUS_AUTO, V4L2_CTRL_TYPE_BOOLEAN, "Focus, Automatic Continuous", 0, 1, 1});
  server.open(open_source);
  const dynamic_reconfigure::Config config = server.settings();
  ASSERT_EQ(config.bools.size(), 1U);
  EXPECT_EQ(config.bools[0].name, "focus_automatic_continuous");
  EXPECT_FALSE(config.bools[0].value);
  EXPECT_EQ(camera.control(V4L2_CID_FOCUS_AUTO).value, 0);
  EXPECT_EQ(camera.control(V4L2_CID_FOCUS_ABSOLUTE).value, 40);
}

// A file that had both names would lose one of the values at the next start.
TEST(ControlServer, savesUnderTheNameThatTheUsersMapHas)
{
  const ros::NodeHandle nh("~aliases");
  nh.setParam("controls/focus_auto", false);
  FakeCamera camera = webcam();
  camera.controls.push_back({V4L2_CID_FOCUS_AUTO, V4L2_CTRL_TYPE_BOOLEAN, "Focus, Automatic Continuous", 0, 1, 1});
  ControlServer server(ros::NodeHandle("~"), ControlDevice([&camera] { return camera.plug(); }),
                       readControlSettings(nh));
  const auto saved = [&server]
  {
    const dynamic_reconfigure::Config config = server.settings();
    std::string text;
    for (const auto& one : config.bools)
      text += one.name + (one.value != 0 ? " on " : " off ");
    for (const auto& one : config.ints)
      text += one.name + " " + std::to_string(one.value);
    return text;
  };
  EXPECT_EQ(saved(), "focus_auto off ");
  const auto source = server.open([&camera] { return std::make_unique<V4l2Source>(camera.plug(), CaptureParams()); });
  EXPECT_EQ(camera.control(V4L2_CID_FOCUS_AUTO).value, 0);
  EXPECT_EQ(saved(), "focus_auto off ");
  dynamic_reconfigure::Reconfigure call;
  call.request.config = brightness(9);
  call.request.config.bools.resize(1);
  call.request.config.bools[0].name = "focus_automatic_continuous";
  call.request.config.bools[0].value = 1;
  EXPECT_TRUE(ros::service::call(ros::NodeHandle("~").resolveName("controls/set_parameters"), call));
  EXPECT_EQ(camera.control(V4L2_CID_FOCUS_AUTO).value, 1);
  EXPECT_EQ(saved(), "focus_auto on brightness 9");
}

TEST(ControlServer, opensTheDeviceOnlyWhileTheCaptureHasNot)
{
  FakeCamera camera = webcam();
  std::promise<void> inside;
  std::promise<void> go_on;
  const auto slow = [&]
  {
    inside.set_value();
    go_on.get_future().wait();
    return camera.plug();
  };
  ControlServer server(ros::NodeHandle("~"), ControlDevice(slow), {});
  auto change = std::async(std::launch::async, [] { return setBrightness(9); });
  inside.get_future().wait();
  std::atomic<bool> begun{false};
  auto opening = std::async(std::launch::async,
                            [&]
                            {
                              return server.open(
                                  [&]
                                  {
                                    begun = true;
                                    return std::make_unique<V4l2Source>(camera.plug(), CaptureParams());
                                  });
                            });
  EXPECT_EQ(opening.wait_for(std::chrono::milliseconds(200)), std::future_status::timeout);
  EXPECT_FALSE(begun);
  go_on.set_value();
  EXPECT_EQ(change.get(), 9);
  EXPECT_TRUE(opening.get());
}

int main(int argc, char** argv)
{
  return runTests(argc, argv, "control_server");
}
