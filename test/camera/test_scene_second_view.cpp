#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/core/affine.hpp>
#include <string>
#include <utility>

#include "core/camera/scene_second_view.hpp"
#include "robot_vision/camera/open_source.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr int kWidth = 160, kHeight = 120;  // px

CaptureParams sceneWith(const std::string& views, const std::string& depth_encoding = "32FC1",
                        const std::string& depth_noise = "none")
{
  CaptureParams params;
  params.source = "synthetic";
  params.image_width = kWidth;
  params.image_height = kHeight;
  params.views = views;
  params.depth_encoding = depth_encoding;
  params.depth_noise = depth_noise;
  return params;
}

// Scenes are slow to build, and they are const, so the tests share this one.
const Scene& sharedScene()
{
  static const Scene scene(SceneParams{kWidth, kHeight});
  return scene;
}

/// The frame of this number.
Frame frameOf(const CaptureParams& params, int number = 0, WantedViews wanted = {})
{
  const auto source = openSource(params);
  Frame frame;
  for (int i = 0; i <= number; ++i)
  {
    frame = Frame();
    frame.wanted = wanted;
    EXPECT_EQ(source->read(frame), ReadResult::kFrame);
  }
  return frame;
}

/// equal() for depths: one NaN is like another.
bool sameBits(const cv::Mat& a, const cv::Mat& b)
{
  return a.size() == b.size() && a.type() == b.type() && a.isContinuous() && b.isContinuous() &&
         std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

/// How many pixels have no depth (CV_32FC1), which equals nothing.
int missing(const cv::Mat& metres)
{
  return static_cast<int>(metres.total()) - cv::countNonZero(metres == metres);
}

}  // namespace

TEST(SceneViews, areAPairAtTheSameMoment)
{
  const auto source = openSource(sceneWith("stereo"));
  EXPECT_EQ(source->description(), "synthetic scene (room) 160x120 and 160x120 at 30 Hz");
  ASSERT_NE(source->secondCamera(), nullptr);
  EXPECT_EQ(source->secondCamera()->pose.translation()[0], kSceneStereoBaseline);
  for (int i = 0; i < 2; ++i)
  {
    Frame frame;
    ASSERT_EQ(source->read(frame), ReadResult::kFrame);
    cv::Mat left, right;
    sharedScene().render(i, left);
    sharedScene().render(i, right, SceneView::kRight);
    EXPECT_TRUE(equal(frame.image, left));
    EXPECT_TRUE(equal(frame.second.pixels, right));
    EXPECT_EQ(frame.second.encoding, "bgr8");
    EXPECT_EQ(frame.truth->frame, i);
  }
}

TEST(SceneViews, haveExactDepthBesideColor)
{
  const Frame frame = frameOf(sceneWith("rgbd"), 1);
  cv::Mat color, depth;
  sharedScene().render(1, color);
  sharedScene().renderDepth(1, depth);
  EXPECT_TRUE(equal(frame.image, color));
  EXPECT_TRUE(sameBits(frame.second.pixels, depth));
  EXPECT_EQ(frame.second.encoding, "32FC1");
  const auto source = openSource(sceneWith("rgbd"));
  EXPECT_EQ(source->secondCamera()->model.width, depth.cols);
  EXPECT_EQ(source->secondCamera()->pose.translation(), sharedScene().viewPose(SceneView::kDepth).translation());
}

TEST(SceneViews, haveDepthInMillimetresWithZeroForNone)
{
  const cv::Mat metres = frameOf(sceneWith("rgbd", "32FC1", "kinect")).second.pixels;
  const EncodedImage depth = frameOf(sceneWith("rgbd", "16UC1", "kinect")).second;
  ASSERT_EQ(depth.encoding, "16UC1");
  ASSERT_EQ(depth.pixels.type(), CV_16UC1);
  ASSERT_EQ(depth.pixels.size(), metres.size());
  ASSERT_GT(missing(metres), 0);
  for (int y = 0; y < metres.rows; ++y)
    for (int x = 0; x < metres.cols; ++x)
    {
      const float z = metres.at<float>(y, x);
      const double millimetres = depth.pixels.at<std::uint16_t>(y, x);
      ASSERT_NEAR(millimetres, std::isnan(z) ? 0.0 : 1000.0 * z, 0.501);
    }
}

TEST(SceneViews, haveTheNoiseOfASensorWhetherOrNotColorIsWanted)
{
  const cv::Mat exact = frameOf(sceneWith("rgbd"), 1).second.pixels;
  for (const char* sensor : {"kinect", "stereo", "tof"})
  {
    const cv::Mat noisy = frameOf(sceneWith("rgbd", "32FC1", sensor), 1).second.pixels;
    EXPECT_GT(cv::countNonZero(noisy != exact), static_cast<int>(exact.total() / 2)) << sensor;
    EXPECT_GT(missing(noisy), 0) << sensor;
    EXPECT_LT(missing(noisy), static_cast<int>(exact.total() / 2)) << sensor;
    EXPECT_TRUE(sameBits(frameOf(sceneWith("rgbd", "32FC1", sensor), 1, {false, true}).second.pixels, noisy)) << sensor;
  }
}

TEST(SceneViews, areNotRenderedUnlessTheyAreWanted)
{
  for (const char* views : {"stereo", "rgbd"})
  {
    const Frame second = frameOf(sceneWith(views), 0, {false, true});
    const Frame first = frameOf(sceneWith(views), 0, {true, false});
    EXPECT_TRUE(second.image.empty() && !second.second.pixels.empty()) << views;
    EXPECT_TRUE(!first.image.empty() && first.second.pixels.empty()) << views;
    EXPECT_NE(frameOf(sceneWith(views), 0, {false, false}).truth, nullptr) << views;
  }
}

TEST(SceneViews, areWrittenIntoTheMemoryTheyAreGiven)
{
  for (const auto& [params, type] : {std::pair(sceneWith("stereo"), CV_8UC3), std::pair(sceneWith("rgbd"), CV_32FC1),
                                     std::pair(sceneWith("rgbd", "16UC1"), CV_16UC1)})
  {
    cv::Mat memory(kHeight, kWidth, type);
    Frame frame;
    frame.second.pixels = memory;
    ASSERT_EQ(openSource(params)->read(frame), ReadResult::kFrame);
    EXPECT_EQ(frame.second.pixels.data, memory.data);
  }
}

TEST(SceneViews, areOneUnlessTwoAreAskedFor)
{
  const auto source = openSource(sceneWith("one"));
  EXPECT_EQ(source->secondCamera(), nullptr);
  Frame frame;
  frame.wanted = {false, true};
  ASSERT_EQ(source->read(frame), ReadResult::kFrame);
  EXPECT_FALSE(frame.image.empty());
  EXPECT_TRUE(frame.second.pixels.empty());
}

TEST(SceneViews, areNamedIfTheyAreNoChoice)
{
  EXPECT_EQ(refusalWith(&CaptureParams::views, "two"), "views is 'two', must be one, stereo or rgbd");
  EXPECT_EQ(refusalWith(&CaptureParams::views, "rgbd"),
            "views is 'rgbd', must be one or stereo, as a V4L2 camera or a stream has no depths beside its colors");
  EXPECT_EQ(refusalWith(&CaptureParams::depth_noise, "much"),
            "depth_noise is 'much', must be none, kinect, stereo or tof");
  EXPECT_EQ(refusalWith(&CaptureParams::depth_encoding, "64FC1"), "depth_encoding is '64FC1', must be 16UC1 or 32FC1");
  EXPECT_EQ(refusal([] { validate(sceneWith("rgbd")); }), "");
}

// A depth camera 0.1 m to the left of a color camera with the same lens, f = 100 px: what is 2 m away is seen by the
// color camera 5 px more to the left.
TEST(DepthBrightness, isThatOfTheColorImageWhereItShowsTheSameThing)
{
  CameraModel camera;
  camera.width = 40;
  camera.height = 30;
  camera.K = {100, 0, 19.5, 0, 100, 14.5, 0, 0, 1};
  DepthBrightness brightness(camera, camera, cv::Affine3d().translate({-0.1, 0, 0}));
  cv::Mat bgr = noise({40, 30}, CV_8UC3), gray = converted(bgr, cv::COLOR_BGR2GRAY);
  cv::Mat metres(30, 40, CV_32FC1, cv::Scalar(2.0));
  metres.at<float>(7, 20) = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat seen = brightness.measure(bgr, metres);
  ASSERT_EQ(seen.type(), CV_8UC1);
  ASSERT_EQ(seen.size(), metres.size());
  EXPECT_EQ(seen.at<uchar>(7, 20), 128);
  EXPECT_EQ(cv::countNonZero(seen.colRange(0, 5) != 128), 0);
  cv::Mat expected = gray.colRange(0, 35).clone();
  expected.at<uchar>(7, 15) = 128;
  EXPECT_TRUE(equal(seen.colRange(5, 40), expected));
}
