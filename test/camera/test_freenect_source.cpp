#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "core/camera/freenect_source.hpp"
#include "robot_vision/common/monotonic.hpp"
#include "support/fake_freenect.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

using Clock = std::chrono::steady_clock;
using Event = FakeKinect::Event;

constexpr std::chrono::seconds kDeadline{60};
constexpr auto kColor = KinectCamera::kColor, kDepth = KinectCamera::kDepth;
constexpr int kShift = 900;

CaptureParams kinect(const std::string& name = "0", const std::string& views = "rgbd")
{
  CaptureParams params;
  params.source = "freenect:" + name;
  params.views = views;
  return params;
}

/// A color image and a depth image of the same moment.
std::vector<Event> moment(int number, int color = 7, int shift = kShift)
{
  const auto ticks = static_cast<std::uint32_t>(2000000 * number);
  return {{kColor, ticks, color, 0, ""}, {kDepth, ticks + 60000, shift, 0, ""}};
}

/// Reads until there is a frame.
Frame frameOf(FrameSource& source, WantedViews wanted = {})
{
  const auto end = Clock::now() + kDeadline;
  Frame frame;
  ReadResult result = ReadResult::kTimeout;
  while (result == ReadResult::kTimeout && Clock::now() < end)
  {
    frame = Frame();
    frame.wanted = wanted;
    result = source.read(frame);
  }
  EXPECT_EQ(result, ReadResult::kFrame);
  return frame;
}

/// Reads nothing until the camera has been started.
void startUp(FrameSource& source, FakeKinect& fake, KinectCamera camera, WantedViews wanted)
{
  const auto end = Clock::now() + kDeadline;
  Frame frame;
  frame.wanted = wanted;
  EXPECT_EQ(source.read(frame), ReadResult::kTimeout);
  while (!fake.runs(camera) && Clock::now() < end)
    std::this_thread::yield();
  EXPECT_TRUE(fake.runs(camera));
}

std::string openError(FakeKinect& fake, const CaptureParams& params)
{
  return refusal<SourceUnavailable>([&] { FreenectSource(fake.library(), params); });
}

/// The error that ends the reading.
std::string readError(FrameSource& source)
{
  const auto end = Clock::now() + kDeadline;
  return refusal<SourceUnavailable>(
      [&]
      {
        for (Frame frame; Clock::now() < end;)
          source.read(frame);
      });
}

bool allEqual(const cv::Mat& image, int value)
{
  return !image.empty() && cv::countNonZero(image.reshape(1) != value) == 0;
}

}  // namespace

TEST(FreenectSource, givesColorAndDepthOfEachMoment)
{
  FakeKinect fake;
  FreenectSource source(fake.library(), kinect());
  EXPECT_EQ(source.description(), "640x480 color and 640x480 depth at 30 Hz from the Kinect freenect:0");
  EXPECT_EQ(source.warning(), "");
  EXPECT_EQ(source.rate(), 0.0);
  EXPECT_FALSE(fake.video_runs || fake.depth_runs);  // until it is read
  const KinectDepths depths = kinectDepths({});
  std::int64_t last = monotonicNow();
  for (int i = 0; i < 4; ++i)
  {
    fake.send(moment(i, 10 + i, kShift + i));
    const Frame frame = frameOf(source);
    EXPECT_EQ(frame.encoding, "rgb8");
    EXPECT_EQ(frame.image.size(), cv::Size(640, 480));
    EXPECT_TRUE(allEqual(frame.image, 10 + i));
    EXPECT_EQ(frame.second.encoding, "16UC1");
    EXPECT_EQ(frame.second.pixels.size(), cv::Size(640, 480));
    EXPECT_TRUE(allEqual(frame.second.pixels, depths[static_cast<std::size_t>(kShift + i)]));
    EXPECT_EQ(frame.sequence, i);
    EXPECT_GE(frame.monotonic_ns, last - 1000000);  // the images are 1 ms apart
    EXPECT_LE(frame.monotonic_ns, monotonicNow());
    last = frame.monotonic_ns;
  }
}

TEST(FreenectSource, writesDepthIntoTheMemoryItIsGiven)
{
  FakeKinect fake;
  FreenectSource source(fake.library(), kinect());
  fake.send(moment(0));
  cv::Mat memory(480, 640, CV_16UC1);
  Frame frame;
  do
  {
    frame.second.pixels = memory;
  } while (source.read(frame) != ReadResult::kFrame);
  EXPECT_EQ(frame.second.pixels.data, memory.data);
}

TEST(FreenectSource, startsOnlyTheCamerasWhoseImagesAreWanted)
{
  FakeKinect fake;
  FreenectSource source(fake.library(), kinect());
  startUp(source, fake, kDepth, {false, true});
  fake.send(moment(0));
  const Frame alone = frameOf(source, {false, true});
  EXPECT_FALSE(fake.runs(kColor));
  EXPECT_TRUE(alone.image.empty() && !alone.wanted.first);
  EXPECT_TRUE(!alone.second.pixels.empty() && alone.wanted.second);
  startUp(source, fake, kColor, {true, true});
  fake.send(moment(1));
  const Frame both = frameOf(source);
  EXPECT_TRUE(!both.image.empty() && !both.second.pixels.empty());
}

TEST(FreenectSource, givesOneViewInTheFormatThatIsAskedFor)
{
  const std::vector<std::tuple<std::string, int, std::string, cv::Size, int>> table = {
      {"yuyv", 640, "rgb8", {640, 480}, FREENECT_VIDEO_RGB},
      {"rgb24", 1280, "rgb8", {1280, 1024}, FREENECT_VIDEO_RGB},
      {"bayer_grbg8", 640, "bayer_grbg8", {640, 480}, FREENECT_VIDEO_BAYER},
      {"grey", 640, "mono8", {640, 488}, FREENECT_VIDEO_IR_8BIT},
      {"y10", 640, "mono10", {640, 488}, FREENECT_VIDEO_IR_10BIT},
  };
  for (const auto& [name, width, encoding, size, format] : table)
  {
    FakeKinect fake;
    CaptureParams params = kinect("0", "one");
    params.pixel_format = name;
    params.image_width = width;
    params.image_height = width == 1280 ? 1024 : 480;
    FreenectSource source(fake.library(), params);
    EXPECT_EQ(source.warning(), "") << name;
    fake.send({{kColor, 0, 3, 0, ""}});
    const Frame frame = frameOf(source, {true, false});
    EXPECT_EQ(frame.encoding, encoding);
    EXPECT_EQ(frame.image.size(), size);
    EXPECT_EQ(fake.video_mode.video_format, format);
    EXPECT_EQ(frame.image.total() * frame.image.elemSize(), static_cast<std::size_t>(fake.video_mode.bytes));
    EXPECT_FALSE(fake.runs(kDepth));
    EXPECT_EQ(source.secondCamera(), nullptr);
    EXPECT_EQ(source.cameraModel() == nullptr, encoding.find("mono") == 0);
  }
}

TEST(FreenectSource, isNamedByTheParameterOfTheDeviceToo)
{
  FakeKinect fake;
  CaptureParams params = kinect();
  params.video_device = params.source;
  params.source.clear();
  const FreenectSource source(fake.library(), params);
  EXPECT_EQ(source.description(), "640x480 color and 640x480 depth at 30 Hz from the Kinect freenect:0");
}

TEST(FreenectSource, givesDepthsAlone)
{
  FakeKinect fake;
  CaptureParams params = kinect("0", "one");
  params.pixel_format = "z16";
  params.image_width = 1280;
  FreenectSource source(fake.library(), params);
  EXPECT_EQ(source.description(), "640x480 depth at 30 Hz from the Kinect freenect:0");
  EXPECT_DOUBLE_EQ(source.period(), 1.0 / 30.0);
  EXPECT_EQ(source.warning(), "freenect:0: gives 640x480 instead of 1280x480");
  fake.send({{kDepth, 0, kShift, 0, ""}});
  const Frame frame = frameOf(source, {true, false});
  EXPECT_EQ(frame.encoding, "16UC1");
  EXPECT_TRUE(allEqual(frame.image, kinectDepths({})[kShift]));
  EXPECT_FALSE(fake.runs(kColor));
  EXPECT_NEAR(source.cameraModel()->K(0, 0), 575.8, 0.1);
}

TEST(FreenectSource, measuresAsTheKinectTells)
{
  FakeKinect fake;
  fake.const_shift = 190.0;
  fake.reference_distance = 110.0F;
  const FreenectSource source(fake.library(), kinect());
  EXPECT_NEAR(source.secondCamera()->model.K(0, 0), 110.0 / (2 * 0.1042), 1e-3);
  EXPECT_EQ(source.cameraModel()->K(0, 0), 525.0);
  EXPECT_NE(source.housing(), nullptr);
  EXPECT_EQ(fake.registrations, 0);  // it has given back all that it was told
  fake.reference_distance = 0.0F;
  EXPECT_NEAR(FreenectSource(fake.library(), kinect()).secondCamera()->model.K(0, 0), 575.8, 0.1);
  fake.tells_registration = false;
  EXPECT_NEAR(FreenectSource(fake.library(), kinect()).secondCamera()->model.K(0, 0), 575.8, 0.1);
}

TEST(FreenectSource, opensTheKinectThatIsNamed)
{
  const std::vector<std::pair<std::string, std::string>> table = {{"", "0"},
                                                                  {"0", "0"},
                                                                  {"1", "1"},
                                                                  {"#1", "0"},
                                                                  {"#2", "1"},
                                                                  {"B00367707227042B", "B00367707227042B"},
                                                                  {"0000000000000000", "0000000000000000"}};
  for (const auto& [name, opened] : table)
  {
    FakeKinect fake;
    fake.serials = {"0000000000000000", "B00367707227042B"};
    EXPECT_EQ(openError(fake, kinect(name)), "");
    EXPECT_EQ(fake.opened, opened);
    EXPECT_EQ(fake.contexts, 0);
    EXPECT_EQ(fake.devices, 0);
  }
}

TEST(FreenectSource, saysWhyItCannotBeOpened)
{
  struct Case
  {
    std::string name;
    std::function<void(FakeKinect&)> make;
    std::string error;
  };
  const auto as_it_is = [](FakeKinect&) {};
  const auto failing = [](const std::string& log)
  {
    return [log](FakeKinect& fake)
    {
      fake.open_error = -1;
      fake.open_log = log;
    };
  };
  const std::string name = "expected the number of a Kinect, such as freenect:0, or its serial number";
  const std::string join =
      "libfreenect's udev rule gives it to the group plugdev: join with `sudo usermod -aG plugdev "
      "$USER`, log in again, and plug it in again";
  const std::vector<Case> cases = {
      {"0", [](FakeKinect& fake) { fake.init_error = -99; }, "USB cannot be used: libfreenect's error -99"},
      {"0", [](FakeKinect& fake) { fake.serials.clear(); },
       "no Kinect is plugged in; its cameras need its own power supply, too"},
      {"1", as_it_is, "there is no Kinect of this number, only 1, with serial numbers A00363A05643046A"},
      {"#0", as_it_is, name},
      {"2@3", as_it_is, name},
      {"B00", as_it_is,
       "no Kinect that may be opened has this serial number; there are 1, with serial numbers A00363A05643046A"},
      {"0", failing("Could not open camera: -3\n"), "cannot be opened: Could not open camera: -3; " + join},
      {"0", failing("Failed to claim camera interface: LIBUSB_ERROR_BUSY\n"),
       "cannot be opened: Failed to claim camera interface: LIBUSB_ERROR_BUSY; another program uses it"},
  };
  for (const Case& each : cases)
  {
    FakeKinect fake;
    each.make(fake);
    EXPECT_EQ(openError(fake, kinect(each.name)), "freenect:" + each.name + ": " + each.error);
    EXPECT_EQ(fake.contexts, 0);
    EXPECT_EQ(fake.devices, 0);
  }
}

TEST(FreenectSource, saysThatItIsGoneWhenAllHasBeenRead)
{
  FakeKinect fake;
  {
    FreenectSource source(fake.library(), kinect());
    fake.send(moment(0));
    frameOf(source);
    fake.send({{kColor, 0, 0, -10, ""}});  // a signal, which harms nothing
    fake.send(moment(1, 8));
    EXPECT_TRUE(allEqual(frameOf(source).image, 8));
    fake.send({{kColor, 0, 0, -1, "USB device disappeared, cancelling stream 81 :(\n"}});
    EXPECT_EQ(readError(source),
              "freenect:0: the Kinect is gone, or its recording has ended: USB device disappeared, cancelling stream "
              "81 :(");
  }
  EXPECT_FALSE(fake.video_runs || fake.depth_runs);
  EXPECT_EQ(fake.contexts, 0);
  EXPECT_EQ(fake.devices, 0);
}

TEST(FreenectSource, saysThatItCannotBeStarted)
{
  FakeKinect fake;
  fake.starts = false;
  FreenectSource source(fake.library(), kinect());
  EXPECT_EQ(readError(source), "freenect:0: its color camera cannot be started: libfreenect's error -1");
}

TEST(FreenectSource, canBeOpenedAgainAndAgain)
{
  FakeKinect fake;
  for (int i = 0; i < 20; ++i)
  {
    FreenectSource source(fake.library(), kinect());
    fake.send(moment(2 * i));
    EXPECT_EQ(frameOf(source).sequence, 0);
    fake.send(moment(2 * i + 1));  // which nobody reads
  }
  EXPECT_EQ(fake.contexts, 0);
}

TEST(FreenectParams, areRefusedThatNoKinectHas)
{
  CaptureParams params = kinect("0", "stereo");
  EXPECT_EQ(refusal([&] { validate(params); }), "views is 'stereo', must be one or rgbd for a Kinect");
  params = kinect();
  params.pixel_format = "z16";
  EXPECT_EQ(refusal([&] { validate(params); }),
            "pixel_format is 'z16', must be one of colors, such as rgb24, with the views rgbd");
  params.views = "one";
  EXPECT_EQ(refusal([&] { validate(params); }), "");
  EXPECT_EQ(sourceKind(params), SourceKind::kKinect);
  EXPECT_TRUE(mayComeLater(SourceKind::kKinect));
}
