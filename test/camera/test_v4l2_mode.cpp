#include <gtest/gtest.h>

#include <algorithm>

#include "core/camera/v4l2_formats.hpp"
#include "core/camera/v4l2_mode.hpp"
#include "support/fake_v4l2.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// A webcam that offers large images in a compressed format only.
FakeCamera webcam()
{
  FakeCamera camera;
  const std::vector<FakeCamera::Size> small = {{640, 480, {30.0, 15.0}}, {320, 240, {60.0}}};
  camera.formats = {{V4L2_PIX_FMT_YUYV, 16, small},
                    {V4L2_PIX_FMT_NV12, 12, small},
                    {V4L2_PIX_FMT_HEVC, 8, small},
                    {V4L2_PIX_FMT_MJPEG, 16, {{1920, 1080, {30.0}}, {640, 480, {30.0}}}}};
  return camera;
}

V4l2Mode negotiate(FakeCamera& camera, const CaptureParams& params)
{
  return negotiateFormat(*camera.plug(), params);
}

}  // namespace

TEST(V4l2Mode, isWhatWasAskedForIfTheDeviceOffersIt)
{
  FakeCamera camera = webcam();
  const V4l2Mode mode = negotiate(camera, withFormat("mjpeg", 1920, 1080, 30.0));
  EXPECT_EQ(describe(mode), "MJPG 1920x1080");
  EXPECT_STREQ(mode.format->encoding, "jpeg");
  EXPECT_EQ(mode.rate, 30.0);
  EXPECT_EQ(mode.warning, "");
}

TEST(V4l2Mode, isTheNearestWithAWarningThatListsTheOthers)
{
  const std::string offers = "; it offers YUYV, NV12: 640x480, 320x240; MJPG: 1920x1080, 640x480";
  const std::vector<std::tuple<CaptureParams, std::string, std::string>> table = {
      {withFormat("yuyv", 800, 600), "YUYV 640x480", "asked for YUYV 800x600, gives YUYV 640x480" + offers},
      {withFormat("nv12", 100, 100), "NV12 320x240", "asked for NV12 100x100, gives NV12 320x240" + offers},
      {withFormat("uyvy", 640, 480), "YUYV 640x480", "asked for UYVY 640x480, gives YUYV 640x480" + offers},
      {withFormat("uyvy", 1280, 1024), "MJPG 1920x1080", "asked for UYVY 1280x1024, gives MJPG 1920x1080" + offers},
      {withFormat("yuyv", 640, 480, 100.0), "YUYV 640x480", "asked for 100 Hz, gives 30; YUYV 640x480 has 30, 15 Hz"},
      {withFormat("yuyv", 320, 200, 30.0), "YUYV 320x240",
       "asked for YUYV 320x200, gives YUYV 320x240" + offers + "; asked for 30 Hz, gives 60; YUYV 320x240 has 60 Hz"},
      {withFormat("yuyv", 640, 480, 29.97), "YUYV 640x480", ""},
      {withFormat("yuv", 640, 480, 16.0), "YUYV 640x480", "asked for 16 Hz, gives 15; YUYV 640x480 has 30, 15 Hz"},
  };
  for (const auto& [params, expected, warning] : table)
  {
    FakeCamera camera = webcam();
    const V4l2Mode mode = negotiate(camera, params);
    EXPECT_EQ(describe(mode), expected);
    EXPECT_EQ(mode.warning, warning);
    EXPECT_EQ(describeFormat(camera.format.pixelformat, camera.format.width, camera.format.height), expected);
  }
}

TEST(V4l2Mode, isFoundByTryingIfTheDriverListsNothing)
{
  FakeCamera camera = webcam();
  camera.enumerates = false;
  // Drivers silently keep their format if they do not have the one asked for.
  const V4l2Mode kept = negotiate(camera, withFormat("uyvy", 640, 480));
  EXPECT_EQ(describe(kept), "YUYV 640x480");
  EXPECT_STREQ(kept.format->encoding, "yuv422_yuy2");
  EXPECT_EQ(kept.warning, "asked for UYVY 640x480, gives YUYV 640x480");

  camera.formats = {{V4L2_PIX_FMT_HEVC, 8, {{640, 480, {30.0}}}}, {V4L2_PIX_FMT_NV12, 12, {{640, 480, {30.0}}}}};
  EXPECT_EQ(describe(negotiate(camera, withFormat("yuyv", 640, 480))), "NV12 640x480");
}

TEST(V4l2Mode, isRefusedIfNoFormatIsUsable)
{
  for (const bool enumerates : {true, false})
  {
    FakeCamera camera;
    camera.formats = {{V4L2_PIX_FMT_HEVC, 8, {{640, 480, {30.0}}}}};
    camera.enumerates = enumerates;
    EXPECT_EQ(refusal<SourceUnavailable>([&] { negotiate(camera, CaptureParams()); }),
              std::string("/dev/video0: ") + (enumerates ? "offers HEVC, but none of " : "gives none of ") +
                  v4l2FormatNames());
  }
}

TEST(V4l2Mode, findsSizesInRanges)
{
  FakeCamera camera;
  camera.formats = {{V4L2_PIX_FMT_YUYV, 16, {{640, 480, {30.0}}}, {32, 1920, 16, 24, 1080, 8}}};
  const V4l2Mode mode = negotiate(camera, withFormat("yuyv", 650, 481));
  EXPECT_EQ(describe(mode), "YUYV 656x480");
  EXPECT_EQ(mode.warning,
            "asked for YUYV 650x481, gives YUYV 656x480; it offers YUYV: 32x24 to 1920x1080 in steps of 16x8");
  EXPECT_EQ(describe(negotiate(camera, withFormat("yuyv", 4000, 16))), "YUYV 1920x24");
}

TEST(V4l2Mode, takesTenBitGrayThatIsCalledYuyv)
{
  FakeCamera camera;
  const V4l2Mode mode = negotiate(camera, withFormat("yuvmono10", 640, 480));
  EXPECT_STREQ(mode.format->encoding, "mono10");
  EXPECT_EQ(mode.warning, "");
}

TEST(V4l2Mode, treatsFailedCallsAsALostDevice)
{
  FakeCamera camera;
  camera.faults[VIDIOC_S_FMT] = {EBUSY};
  EXPECT_THROW(negotiate(camera, CaptureParams()), SourceUnavailable);
  camera.faults[VIDIOC_S_PARM] = {EBUSY};  // then the present rate stays
  EXPECT_EQ(negotiate(camera, CaptureParams()).rate, 30.0);
  camera.faults[VIDIOC_G_PARM] = {ENOTTY};
  EXPECT_EQ(negotiate(camera, CaptureParams()).rate, 0.0);
}

TEST(V4l2Offers, findTheNearestRate)
{
  const std::vector<V4l2Periods> discrete = {{{1, 30}, {1, 30}}, {{2, 15}, {2, 15}}, {{1, 5}, {1, 5}}};
  EXPECT_EQ(rateOf(nearestPeriod(discrete, 24.0)), 30.0);
  EXPECT_EQ(rateOf(nearestPeriod(discrete, 8.0)), 7.5);
  EXPECT_EQ(rateOf(nearestPeriod(discrete, 0.5)), 5.0);
  EXPECT_EQ(describeRates(discrete), "30, 7.5, 5 Hz");
  const std::vector<V4l2Periods> range = {{{1, 60}, {1, 1}}};
  EXPECT_EQ(rateOf(nearestPeriod(range, 24.5)), 24.5);
  EXPECT_EQ(rateOf(nearestPeriod(range, 100.0)), 60.0);
  EXPECT_EQ(rateOf(nearestPeriod(range, 0.1)), 1.0);
  EXPECT_EQ(describeRates(range), "1 to 60 Hz");
}

TEST(V4l2Offers, knowRatesBelowOnePerSecond)
{
  const std::vector<V4l2Periods> slow = {{{5, 1}, {5, 1}}, {{3600, 1}, {3600, 1}}};
  EXPECT_EQ(describeRates(slow), "0.2, 0.000278 Hz");
  EXPECT_EQ(rateOf(nearestPeriod(slow, 0.1)), 1.0 / 3600.0);
  const std::vector<V4l2Periods> range = {{{1, 30}, {100000, 1}}};
  EXPECT_EQ(rateOf(nearestPeriod(range, 0.0002)), 0.0002);
  for (const double rate : {1e-9, 0.0002, 0.25, 29.97, 1000.0})
  {
    EXPECT_GT(periodOf(rate).numerator, 0U);
    EXPECT_NEAR(rateOf(periodOf(rate)), std::max(rate, 2.5e-7), 0.001 * rate) << rate;
  }
}

TEST(V4l2Mode, saysHowInterlacedImagesDifferFromFrames)
{
  const std::vector<std::pair<std::uint32_t, std::string>> table = {
      {V4L2_FIELD_NONE, ""},
      {V4L2_FIELD_ALTERNATE, "its images are single fields"},
      {V4L2_FIELD_SEQ_BT, "its images are two fields, one below the other"},
      {V4L2_FIELD_INTERLACED_TB, "its images are interlaced: what moves has combed edges"},
      {V4L2_FIELD_INTERLACED_BT, "its images are interlaced: what moves has combed edges"},
  };
  for (const auto& [field, warning] : table)
  {
    FakeCamera camera;
    camera.field = field;
    EXPECT_EQ(negotiate(camera, CaptureParams()).warning, warning);
  }
}
