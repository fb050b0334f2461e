#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/camera/frame_watchdog.hpp"
#include "core/camera/v4l2_source.hpp"
#include "robot_vision/camera/capture_loop.hpp"
#include "support/fake_v4l2.hpp"
#include "support/temp_folder.hpp"

using namespace robot_vision;

namespace
{

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kDeadline{60};

/// The ioctl calls of streaming and their names.
const std::vector<std::pair<unsigned long, std::string>> kStreamingCalls = {
    {VIDIOC_REQBUFS, "VIDIOC_REQBUFS"},   {VIDIOC_QUERYBUF, "VIDIOC_QUERYBUF"}, {VIDIOC_QBUF, "VIDIOC_QBUF"},
    {VIDIOC_STREAMON, "VIDIOC_STREAMON"}, {VIDIOC_DQBUF, "VIDIOC_DQBUF"},
};

/// A capture loop on a fake camera. A test changes the camera in the loop's thread, in the callbacks.
class Capture : public CaptureListener
{
public:
  FakeCamera camera;
  CaptureParams params;
  std::function<void(const Frame&)> on_frame;
  std::function<void()> on_unavailable;
  std::function<void()> on_idle;
  std::atomic<int> opened{0};
  std::atomic<int> prepared{0};
  WantedViews wanted;                // what it asks for; in the loop's thread
  std::vector<double> rates;         // those of the sources that it is told of, Hz
  std::string loss;                  // the last reason for which there was no source
  std::string file = "/dev/video0";  // the file that the loop looks for while it is idle
  std::function<std::unique_ptr<FrameSource>(const CaptureParams&)> open = [this](const CaptureParams& p)
  { return std::make_unique<V4l2Source>(camera.plug(file), p); };

  void start(Demand demand)
  {
    CaptureListener& listener = *this;
    loop_ = std::make_unique<CaptureLoop>(params, listener,
                                          [this](const CaptureParams& p)
                                          {
                                            ++opened;
                                            return open(p);
                                          });
    loop_->setDemand(demand);
  }

  void demand(Demand demand) { loop_->setDemand(demand); }
  void pace(double framerate) { loop_->setPace(framerate, /*loop=*/false); }

  /// Ends the test; to be called in the loop's thread.
  void finish()
  {
    finished_ = true;
    done_.set_value();
  }

  void runUntilFinished()
  {
    start(Demand::kFrames);
    waitUntilFinished();
  }

  void runUntilTheFirstFrame()
  {
    on_frame = [this](const Frame&) { finish(); };
    runUntilFinished();
  }

  void waitUntilFinished()
  {
    EXPECT_EQ(done_.get_future().wait_for(kDeadline), std::future_status::ready);
    loop_.reset();  // must come before done_ is replaced, because the loop's thread may still be in set_value()
    done_ = std::promise<void>();
    finished_ = false;
  }

private:
  void onOpened(const FrameSource& source) override { rates.push_back(source.rate()); }
  WantedViews wantedViews() override { return wanted; }
  void prepare(Frame&) override { ++prepared; }
  void onFrame(const Frame& frame) override
  {
    if (on_frame && !finished_) on_frame(frame);
  }
  void onRefused(const std::string&) override {}
  void onUnavailable(const std::string& reason) override
  {
    if (finished_) return;
    loss = reason;
    if (on_unavailable) on_unavailable();
  }
  void onIdle() override
  {
    if (on_idle && !finished_) on_idle();
  }
  void onEnd(const std::string& error) override { ADD_FAILURE() << error; }

  bool finished_ = false;
  std::promise<void> done_;
  std::unique_ptr<CaptureLoop> loop_;
};

/// A live stream whose first keyframe comes late.
class LateKeyframe : public FrameSource
{
public:
  explicit LateKeyframe(Clock::duration wait) : keyframe_(Clock::now() + wait) {}
  ReadResult read(Frame& frame) override
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (Clock::now() < keyframe_) return ReadResult::kNoImage;
    frame.image = cv::Mat(1, 1, CV_8UC1);
    return ReadResult::kFrame;
  }
  double rate() const override { return 0.0; }
  std::string description() const override { return "stream"; }

private:
  Clock::time_point keyframe_;
};

/// A scene whose rate can be changed.
class SteadyScene : public FrameSource
{
public:
  ReadResult read(Frame& frame) override
  {
    frame.image = cv::Mat(1, 1, CV_8UC1);
    return ReadResult::kFrame;
  }
  double rate() const override { return rate_; }
  bool setRate(double rate) override
  {
    rate_ = rate;
    return true;
  }
  std::string description() const override { return "scene"; }

private:
  double rate_ = 1000.0;  // Hz
};

std::size_t entries(const char* folder)
{
  const std::filesystem::directory_iterator begin(folder);
  return static_cast<std::size_t>(std::distance(begin, {}));
}

}  // namespace

TEST(CaptureLoop, survivesTwentyUnpluggingsAndLeaksNothing)
{
  Capture capture;
  int cycles = 0;
  const std::size_t descriptors = entries("/proc/self/fd");
  const std::size_t threads = entries("/proc/self/task");  // may count a thread that another test has just joined
  capture.on_frame = [&](const Frame& frame)
  {
    EXPECT_EQ(frame.sequence, 0);
    EXPECT_EQ(capture.camera.open_devices, 1);
    if (cycles == 20) return capture.finish();
    capture.camera.plugged = false;
  };
  capture.on_unavailable = [&]
  {
    EXPECT_EQ(capture.loss, "/dev/video0: VIDIOC_QBUF failed: No such device");
    EXPECT_EQ(capture.camera.open_devices, 0);
    EXPECT_EQ(capture.camera.maps, 0);
    EXPECT_EQ(entries("/proc/self/fd"), descriptors);
    EXPECT_LE(entries("/proc/self/task"), threads + 1);
    ++cycles;
    capture.camera.replug();
  };
  capture.runUntilFinished();
  EXPECT_EQ(capture.opened, 21);
  EXPECT_EQ(capture.camera.open_devices, 0);
  // The kernel may still list a thread that has been joined.
  for (const auto end = Clock::now() + kDeadline; entries("/proc/self/task") > threads && Clock::now() < end;)
    std::this_thread::yield();
  EXPECT_LE(entries("/proc/self/task"), threads);
}

TEST(CaptureLoop, keepsTheKindThatItsSourceHadAtTheStart)
{
  const TempFolder folder;
  Capture capture;
  capture.params.source = (folder.path() / "camera").string();
  std::filesystem::create_symlink("/dev/null", capture.params.source);
  std::vector<SourceKind> kinds;
  capture.open = [&](const CaptureParams& p)
  {
    kinds.push_back(sourceKind(p));
    return std::make_unique<V4l2Source>(capture.camera.plug(), p);
  };
  capture.on_frame = [&](const Frame&)
  {
    if (kinds.size() == 2) return capture.finish();
    std::filesystem::remove(capture.params.source);
    capture.camera.plugged = false;
  };
  capture.on_unavailable = [&] { capture.camera.replug(); };
  capture.runUntilFinished();
  EXPECT_EQ(kinds, (std::vector<SourceKind>{SourceKind::kDevice, SourceKind::kDevice}));
}

TEST(CaptureLoop, streamsAgainAfterEachCallThatFails)
{
  for (const auto& [request, name] : kStreamingCalls)
  {
    Capture capture;
    capture.camera.faults[request] = {EIO};
    capture.runUntilTheFirstFrame();
    EXPECT_EQ(capture.loss, "/dev/video0: " + name + " failed: Input/output error");
    EXPECT_EQ(capture.opened, 2);
    EXPECT_EQ(capture.camera.open_devices, 0);
    EXPECT_EQ(capture.camera.maps, 0);
  }
}

TEST(CaptureLoop, reopensADeviceThatStalls)
{
  Capture capture;
  capture.params.timeout = 0.2;
  capture.on_frame = [&](const Frame&)
  {
    if (!capture.loss.empty()) return capture.finish();
    capture.camera.stalled = true;
  };
  capture.on_unavailable = [&] { capture.camera.stalled = false; };
  capture.runUntilFinished();
  EXPECT_EQ(capture.loss, "YUYV 640x480 at 30 Hz from /dev/video0: no frame for 0.2 s");
}

TEST(CaptureLoop, reopensADeviceThatGivesOnlyDamagedFrames)
{
  Capture capture;
  capture.params.timeout = 0.2;
  capture.camera.damaged = std::numeric_limits<unsigned>::max();
  capture.on_unavailable = [&] { capture.camera.damaged = 0; };
  capture.runUntilTheFirstFrame();
  EXPECT_EQ(capture.loss, "YUYV 640x480 at 30 Hz from /dev/video0: no good frame for 0.2 s");
}

TEST(CaptureLoop, waitsForCamerasThatAreSlowerThanTheTimeout)
{
  for (const bool by_exposure : {false, true})
  {
    Capture capture;
    capture.params.timeout = 0.1;
    capture.camera.frame_time = std::chrono::milliseconds(400);
    if (by_exposure)
      capture.camera.controls = {
          {V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CTRL_TYPE_INTEGER, "Exposure Time, Absolute", 1, 10000, 10000}};
    else
      capture.camera.formats[0].sizes = {{640, 480, {1.0}}};
    capture.on_frame = [&](const Frame& frame)
    {
      if (frame.sequence == 2) capture.finish();
    };
    capture.runUntilFinished();
    EXPECT_EQ(capture.loss, "");
    EXPECT_EQ(capture.opened, 1);
  }
}

TEST(CaptureLoop, saysHowLongItHasWaitedForASlowCamera)
{
  Capture capture;
  capture.params.timeout = 0.1;
  capture.camera.formats[0].sizes = {{640, 480, {5.0}}};
  capture.camera.stalled = true;
  capture.on_unavailable = [&] { capture.finish(); };
  capture.runUntilFinished();
  EXPECT_EQ(capture.loss, "YUYV 640x480 at 5 Hz from /dev/video0: no frame for 0.6 s");
}

/// The wait is limited however long an exposure the driver states, and the driver is asked for it once only.
TEST(CaptureLoop, limitsTheWaitForLongExposures)
{
  EXPECT_EQ(frameTimeoutFor(/*period=*/0.0, /*timeout=*/0.5), 0.5);
  EXPECT_EQ(frameTimeoutFor(5.0, 0.5), 15.0);
  EXPECT_EQ(frameTimeoutFor(214748.0, 0.5), 30.0);
  EXPECT_EQ(frameTimeoutFor(214748.0, 100.0), 100.0);

  Capture capture;
  capture.params.timeout = 0.1;
  capture.camera.stalled = true;
  capture.camera.controls = {
      {V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CTRL_TYPE_INTEGER, "Exposure Time, Absolute", 1, 10000, 3000}};
  capture.on_unavailable = [&]
  {
    EXPECT_EQ(capture.loss, "YUYV 640x480 at 30 Hz from /dev/video0: no frame for 0.9 s");
    EXPECT_EQ(capture.camera.calls[VIDIOC_G_EXT_CTRLS], 1);
    capture.finish();
  };
  capture.runUntilFinished();
}

TEST(CaptureLoop, waitsForTheKeyframeOfAStream)
{
  Capture capture;
  capture.params.timeout = 0.2;
  capture.open = [](const CaptureParams&) { return std::make_unique<LateKeyframe>(std::chrono::milliseconds(800)); };
  capture.runUntilTheFirstFrame();
  EXPECT_EQ(capture.loss, "");
  EXPECT_EQ(capture.opened, 1);
  EXPECT_GT(capture.prepared, 0);
}

TEST(CaptureLoop, opensForAnotherRateOnlyWhatTakesOneWhenItIsOpened)
{
  for (const bool stream : {false, true})
  {
    Capture capture;
    if (stream)
    {
      capture.params.source = "rtsp://camera/live";
      capture.open = [](const CaptureParams&) { return std::make_unique<LateKeyframe>(Clock::duration::zero()); };
    }
    int frames = 0;
    capture.on_frame = [&](const Frame&)
    {
      if (++frames == 1) capture.pace(15.0);
      if (frames == 5) capture.finish();
    };
    capture.runUntilFinished();
    EXPECT_EQ(capture.opened, stream ? 1 : 2);
  }
}

TEST(CaptureLoop, givesAnotherRateToASourceThatTakesIt)
{
  Capture capture;
  capture.params.source = "synthetic";
  capture.open = [](const CaptureParams&) { return std::make_unique<SteadyScene>(); };
  int frames = 0;
  capture.on_frame = [&](const Frame&)
  {
    if (++frames == 1) capture.pace(500.0);
    if (capture.rates.size() == 2) capture.pace(0.0);
    if (capture.rates.size() == 3) capture.finish();
  };
  capture.runUntilFinished();
  EXPECT_EQ(capture.opened, 1);
  EXPECT_EQ(capture.rates, (std::vector<double>{1000.0, 500.0, kDefaultRate}));
}

TEST(CaptureLoop, tellsTheSourceWhichViewsAreWanted)
{
  const std::vector<WantedViews> asked = {{true, true}, {false, true}, {true, false}, {false, false}};
  Capture capture;
  std::size_t number = 0;
  capture.wanted = asked[0];
  capture.on_frame = [&](const Frame& frame)
  {
    EXPECT_EQ(frame.wanted.first, asked[number].first);
    EXPECT_EQ(frame.wanted.second, asked[number].second);
    if (++number == asked.size()) return capture.finish();
    capture.wanted = asked[number];
  };
  capture.runUntilFinished();
  EXPECT_EQ(number, asked.size());
}

TEST(CaptureLoop, preparesNoMemoryForADriversImages)
{
  Capture capture;
  capture.runUntilTheFirstFrame();
  EXPECT_EQ(capture.prepared, 0);
}

TEST(CaptureLoop, noticesThatAnUnusedDeviceIsUnplugged)
{
  const TempFolder folder;
  Capture capture;
  capture.file = (folder.path() / "video0").string();
  std::ofstream(capture.file) << "\n";
  capture.on_idle = [&]
  {
    if (capture.opened == 0) return;  // the demand has not been set yet
    if (!capture.loss.empty()) return capture.finish();
    capture.camera.plugged = false;
    std::filesystem::remove(capture.file);
  };
  capture.on_unavailable = [&]
  {
    std::ofstream(capture.file) << "\n";
    capture.camera.replug();
  };
  capture.start(Demand::kIdle);
  capture.waitUntilFinished();
  EXPECT_EQ(capture.loss, capture.file + ": cannot be opened: No such device");
  EXPECT_EQ(capture.opened, 3);
}

TEST(CaptureLoop, triesToReopenALostDeviceLessAndLessOften)
{
  Capture capture;
  std::vector<Clock::time_point> tries;
  capture.camera.plugged = false;
  capture.on_unavailable = [&]
  {
    EXPECT_EQ(capture.loss, "/dev/video0: cannot be opened: No such device");
    tries.push_back(Clock::now());
    if (tries.size() == 6) capture.finish();
  };
  capture.runUntilFinished();
  const double expected[] = {0.1, 0.2, 0.4, 0.8, 1.0};  // s, at least
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_GE(std::chrono::duration<double>(tries[i + 1] - tries[i]).count(), expected[i]) << i;
}

TEST(CaptureLoop, leavesADeviceAloneWhenStopped)
{
  Capture capture;
  capture.on_idle = [&]
  {
    EXPECT_EQ(capture.camera.open_devices, 0);
    EXPECT_EQ(capture.opened, 0);
    capture.finish();
  };
  capture.start(Demand::kStopped);
  capture.waitUntilFinished();

  // While no frames are wanted, the device is opened once to see whether it is there, and closed again.
  capture.on_idle = [&]
  {
    if (capture.opened == 0) return;  // the demand has not been set yet
    EXPECT_EQ(capture.camera.open_devices, 0);
    EXPECT_EQ(capture.opened, 1);
    capture.finish();
  };
  capture.start(Demand::kIdle);
  capture.waitUntilFinished();
}

TEST(CaptureLoop, stopsAndStartsAsItIsTold)
{
  Capture capture;
  int frames = 0;
  capture.on_frame = [&](const Frame& frame)
  {
    if (capture.opened == 2) return capture.finish();
    if (++frames == 3) capture.demand(Demand::kStopped);
    EXPECT_EQ(frame.sequence, frames - 1);
  };
  capture.on_idle = [&]
  {
    if (frames == 0) return;  // the demand has not been set yet
    EXPECT_EQ(frames, 3);
    EXPECT_EQ(capture.camera.open_devices, 0);
    capture.demand(Demand::kFrames);
  };
  capture.runUntilFinished();
}
