#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "robot_vision/stereo/rectifier.hpp"
#include "robot_vision/stereo/stereo_camera.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

RectifiedCamera cameraAt(double cx, double tx)
{
  RectifiedCamera camera;
  camera.model = {64, 48, {60, 0, 31, 0, 61, 23, 0, 0, 1}, {-0.2, 0.05, 0.001, -0.001, 0.0}, "plumb_bob"};
  camera.R = cv::Matx33d::eye();
  camera.P = {50, 0, cx, tx, 0, 52, 24, 0, 0, 0, 1, 0};
  return camera;
}

StereoCamera calibratedPair()
{
  return {cameraAt(32, 0), cameraAt(30, -6)};
}

struct Case
{
  std::function<void(StereoCamera&)> spoil;
  std::string said;
};

}  // namespace

TEST(StereoCamera, hasTheGeometryOfItsP)
{
  const StereoGeometry geometry = geometryOf(calibratedPair());
  EXPECT_EQ(geometry.fx, 50.0);
  EXPECT_EQ(geometry.fy, 52.0);
  EXPECT_EQ(geometry.cx, 32.0);
  EXPECT_EQ(geometry.cy, 24.0);
  EXPECT_EQ(geometry.offset, 2.0);
  EXPECT_NEAR(geometry.baseline, 0.12, 1e-15);
}

TEST(StereoCamera, isRefusedByTheFieldThatNoPairCanHave)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Case> cases = {
      {[](StereoCamera& pair) { pair.left.model.K = cv::Matx33d::zeros(); },
       "left camera: K is 0 everywhere, must be that of a calibrated camera"},
      {[](StereoCamera& pair) { pair.right.R = cv::Matx33d::zeros(); },
       "right camera: R is 0 everywhere, must be that of two cameras calibrated together"},
      {[](StereoCamera& pair) { pair.right.P = cv::Matx34d::zeros(); },
       "right camera: P is 0 everywhere, must be that of two cameras calibrated together"},
      {[](StereoCamera& pair) { pair.left.model.width = 40000; },
       "left camera: width is 40000, must be from 1 to 32767"},
      {[](StereoCamera& pair) { pair.left.model.K(0, 1) = 0.5; }, "left camera: K[1] is 0.5, must be 0"},
      {[](StereoCamera& pair) { pair.right.P(0, 1) = 0.5; }, "right camera: P[1] is 0.5, must be 0"},
      {[](StereoCamera& pair) { pair.right.P(1, 0) = 0.5; }, "right camera: P[4] is 0.5, must be 0"},
      {[](StereoCamera& pair) { pair.right.P(1, 3) = -6; },
       "right camera: P[7] is -6, must be 0, for cameras beside each other"},
      {[=](StereoCamera& pair) { pair.right.P(0, 3) = nan; }, "right camera: P is nan, must be finite"},
      {[](StereoCamera& pair) { pair.right.model.width = 32; },
       "the size of the right camera is 32x48, must be 64x48 as of the left one"},
      {[](StereoCamera& pair) { pair.right.P(0, 0) = 51; },
       "P[0] of the right camera is 51, must be 50 as of the left one; the cameras were not calibrated together"},
      {[](StereoCamera& pair) { pair.right.P(1, 1) = 53; },
       "P[5] of the right camera is 53, must be 52 as of the left one"},
      {[](StereoCamera& pair) { pair.right.P(1, 2) = 25; },
       "P[6] of the right camera is 25, must be 24 as of the left one"},
      {[](StereoCamera& pair) { pair.left.P(0, 3) = -6; }, "P[3] of the left camera is -6, must be 0, as distances"},
      {[](StereoCamera& pair) { pair.right.P(0, 3) = 0; },
       "P[3] of the right camera is 0, must be below 0, -P[0] times the baseline; left and right are swapped"},
      {[](StereoCamera& pair) { pair.right.P = {51, 0, 31, 0, 0, 53, 25, 0, 0, 0, 1, 0}; },
       "P[3] of the right camera is 0, must be below 0, -P[0] times the baseline; left and right are swapped, or not "
       "calibrated together"},
      {[](StereoCamera& pair) { pair.right.P(0, 3) = 6; }, "P[3] of the right camera is 6, must be below 0"},
      {[](StereoCamera& pair) { pair.right.P(0, 3) = -1e-6; },
       "the baseline in m, -P[3] / P[0] of the right camera, is 2e-08, must be from 0.0001 to 10000"},
  };
  for (const Case& one : cases)
  {
    StereoCamera pair = calibratedPair();
    one.spoil(pair);
    const std::string said = refusal([&] { geometryOf(pair); });
    EXPECT_EQ(said.substr(0, one.said.size()), one.said);
  }
}

TEST(StereoCamera, mayHaveNumbersThatAFileHasRounded)
{
  StereoCamera pair = calibratedPair();
  pair.right.P(0, 0) += 5e-4;
  pair.right.P(1, 2) -= 5e-4;
  EXPECT_EQ(refusal([&] { validate(pair); }), "");
}

TEST(StereoRectifier, keepsTheMapsOfACameraThatStaysTheSame)
{
  StereoRectifier rectifier;
  StereoCamera pair = calibratedPair();
  rectifier.setCamera(pair);
  const void *left = rectifier.left().seen().data, *right = rectifier.right().seen().data;
  rectifier.setCamera(calibratedPair());
  EXPECT_EQ(rectifier.left().seen().data, left);
  EXPECT_EQ(rectifier.right().seen().data, right);

  pair.right.P(0, 3) = -12;
  pair.right.model.D[0] = -0.1;
  rectifier.setCamera(pair);
  EXPECT_EQ(rectifier.left().seen().data, left);
  EXPECT_TRUE(rectifier.right().camera() == pair.right);
  EXPECT_NEAR(rectifier.geometry().baseline, 0.24, 1e-15);
}

TEST(StereoRectifier, staysAsItIsWhenACalibrationIsRefused)
{
  StereoRectifier rectifier;
  rectifier.setCamera(calibratedPair());
  const void* left = rectifier.left().seen().data;
  StereoCamera wrong = calibratedPair();
  wrong.left.model.K(0, 0) = 70;
  wrong.right.P(0, 3) = 0;
  EXPECT_NE(refusal([&] { rectifier.setCamera(wrong); }), "");
  EXPECT_EQ(rectifier.left().seen().data, left);
  EXPECT_NEAR(rectifier.geometry().baseline, 0.12, 1e-15);
}

TEST(Rectifier, isMadeOnlyForImagesOfTheCamera)
{
  Rectifier rectifier(cameraAt(32, 0));
  cv::Mat out;
  EXPECT_EQ(refusal(
                [&] {
                  rectifier.apply(noise({63, 48}, CV_8UC3), "bgr8", "bgr8", out);
                }),
            "the image's size is 63x48, must be 64x48 as of the camera");
  EXPECT_EQ(refusal(
                [&] {
                  rectifier.apply(noise({64, 48}, CV_8UC3), "bgr8", "rgb8", out);
                }),
            "the encoding of rectified images is rgb8, must be bgr8 or mono8");
  EXPECT_NE(refusal([&] { rectifier.apply(noise({64, 48}, CV_8UC1), "bgr8", "bgr8", out); }), "");
  EXPECT_NE(refusal([&] { rectifier.apply(cv::Mat(), "bgr8", "bgr8", out); }), "");
}

TEST(Rectifier, doesNotDependOnThePaddingAndLeavesTheInputAsItIs)
{
  Rectifier rectifier(cameraAt(32, 0));
  for (const std::string encoding : {"bgr8", "mono8"})
  {
    const cv::Mat image = colorful({64, 48}, encoding), copy = image.clone();
    const cv::Mat padded = noise({64, 48}, image.type(), 5);
    const cv::Mat tight = padded.clone();
    cv::Mat from_padded, from_tight, first, second;
    rectifier.apply(padded, encoding, "mono8", from_padded);
    rectifier.apply(tight, encoding, "mono8", from_tight);
    EXPECT_TRUE(equal(from_padded, from_tight));
    rectifier.apply(image, encoding, encoding, first);
    const void* memory = first.data;
    rectifier.apply(image, encoding, encoding, first);
    EXPECT_EQ(first.data, memory);
    EXPECT_TRUE(equal(image, copy));
  }
}
