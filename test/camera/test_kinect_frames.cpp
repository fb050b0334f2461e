#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/camera/kinect_frames.hpp"
#include "robot_vision/camera/frame_source.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr auto kColor = KinectCamera::kColor, kDepth = KinectCamera::kDepth;
constexpr std::chrono::milliseconds kNow{0};

/// The images of a small Kinect. Each is one number in all pixels.
class KinectFramesTest : public testing::Test
{
protected:
  /// An image arrives that was taken so many ms after the Kinect's clock began.
  void arrive(KinectCamera camera, double ms, int value, std::int64_t monotonic_ns = 0)
  {
    const cv::Mat memory(camera == kColor ? kColorSize : kDepthSize, camera == kColor ? CV_8UC3 : CV_16UC1,
                         frames_.memory(camera));
    cv::Mat(memory).setTo(cv::Scalar::all(value));
    const auto ticks = static_cast<std::int64_t>(ms * 60000.0);
    frames_.arrived(camera, static_cast<std::uint32_t>(first_tick_ + ticks), monotonic_ns);
  }

  /// The numbers of the newest color image and depth image; -1: there is none.
  std::pair<int, int> taken()
  {
    if (!frames_.take(kNow, frame_)) return {-1, -1};
    const int color = frame_.color.empty() ? -1 : frame_.color.at<cv::Vec3b>(3, 5)[1];
    return {color, frame_.depth.empty() ? -1 : frame_.depth.at<std::uint16_t>(2, 3)};
  }

  const cv::Size kColorSize{6, 4}, kDepthSize{4, 3};
  KinectFrames frames_{kColorSize, CV_8UC3, kDepthSize};
  KinectFrame frame_;
  std::int64_t first_tick_ = 1000;
};

using Numbers = std::pair<int, int>;

}  // namespace

TEST_F(KinectFramesTest, areThoseNearestInTimeWhicheverComesFirst)
{
  for (const double gap : {0.0, 5.0, 16.6, 17.0, 28.0, 33.0})  // ms, from a depth image to the next color image
  {
    double last = 0.0;
    int pairs = 0;
    for (int i = 0; i < 10; ++i)
    {
      arrive(kDepth, 100.0 * gap + 33.3 * i, 100 + i);
      arrive(kColor, 100.0 * gap + 33.3 * i + gap, 10 + i);
      const auto [color, depth] = taken();
      if (color < 0) continue;
      const double apart = 33.3 * (color - 10) + gap - 33.3 * (depth - 100);
      EXPECT_LE(std::abs(apart), 20.0) << gap;
      EXPECT_NEAR(apart, pairs > 0 ? last : apart, 1e-9) << gap;  // it does not jump from one choice to the other
      last = apart;
      ++pairs;
    }
    EXPECT_GE(pairs, 8) << gap;
  }
}

TEST_F(KinectFramesTest, goOnWhenAnImageIsLost)
{
  arrive(kColor, 0, 1);
  arrive(kDepth, 3, 101);
  EXPECT_EQ(taken(), Numbers(1, 101));
  arrive(kColor, 33, 2);  // its depth image is lost
  arrive(kColor, 66, 3);
  arrive(kDepth, 69, 103);
  EXPECT_EQ(taken(), Numbers(3, 103));
  arrive(kDepth, 102, 104);  // its color image is lost
  arrive(kColor, 132, 5);
  EXPECT_EQ(taken(), Numbers(-1, -1));
  arrive(kDepth, 135, 105);
  EXPECT_EQ(taken(), Numbers(5, 105));
  EXPECT_EQ(frame_.sequence, 2);
}

TEST_F(KinectFramesTest, doNotMindThatTheClockWraps)
{
  first_tick_ = std::int64_t{std::numeric_limits<std::uint32_t>::max()} - 60000;  // 1 ms before
  arrive(kColor, 0, 1);
  arrive(kDepth, 3, 101);
  EXPECT_EQ(taken(), Numbers(1, 101));
  arrive(kDepth, 30, 102);
  arrive(kColor, 33, 2);
  EXPECT_EQ(taken(), Numbers(2, 102));
}

TEST_F(KinectFramesTest, haveTheTimeBetweenBothImages)
{
  arrive(kColor, 0, 1, 1000000000);
  arrive(kDepth, 10, 101, 1010000000);
  EXPECT_EQ(taken(), Numbers(1, 101));
  EXPECT_EQ(frame_.monotonic_ns, 1005000000);
}

TEST_F(KinectFramesTest, haveGapsInTheirNumbersWhereNobodyHasTakenThem)
{
  for (int i = 0; i < 3; ++i)
  {
    arrive(kColor, 33.0 * i, i);
    arrive(kDepth, 33.0 * i + 1.0, 100 + i);
  }
  EXPECT_EQ(taken(), Numbers(2, 102));
  EXPECT_EQ(frame_.sequence, 2);
  EXPECT_EQ(taken(), Numbers(-1, -1));
}

TEST_F(KinectFramesTest, stayAsTheyAreUntilTheNextAreTaken)
{
  arrive(kColor, 0, 1);
  arrive(kDepth, 1, 101);
  ASSERT_EQ(taken(), Numbers(1, 101));
  const cv::Mat color = frame_.color, depth = frame_.depth;
  for (int i = 1; i < 6; ++i)
  {
    arrive(kColor, 33.0 * i, 50 + i);
    arrive(kDepth, 33.0 * i + 1.0, 500 + i);
  }
  EXPECT_EQ(cv::countNonZero(color.reshape(1) != 1), 0);
  EXPECT_EQ(cv::countNonZero(depth != 101), 0);
}

TEST_F(KinectFramesTest, haveOnlyWhatIsWanted)
{
  EXPECT_TRUE(frames_.wanted(kColor) && frames_.wanted(kDepth));
  frames_.want(false, true);
  EXPECT_TRUE(!frames_.wanted(kColor) && frames_.wanted(kDepth));
  arrive(kDepth, 0, 101);
  EXPECT_EQ(taken(), Numbers(-1, 101));
  arrive(kColor, 5, 1);
  EXPECT_EQ(taken(), Numbers(-1, -1));
  frames_.want(true, false);
  arrive(kColor, 38, 2);
  EXPECT_EQ(taken(), Numbers(2, -1));
  frames_.want(true, true);
  arrive(kColor, 71, 3);
  EXPECT_EQ(taken(), Numbers(-1, -1));
  arrive(kDepth, 72, 103);
  EXPECT_EQ(taken(), Numbers(3, 103));
}

TEST_F(KinectFramesTest, areAllGivenBeforeTheEnd)
{
  arrive(kColor, 0, 1);
  arrive(kDepth, 1, 101);
  frames_.end("it is gone");
  EXPECT_EQ(taken(), Numbers(1, 101));
  EXPECT_EQ(refusal<SourceUnavailable>([this] { taken(); }), "it is gone");
  EXPECT_EQ(refusal<SourceUnavailable>([this] { taken(); }), "it is gone");
}
