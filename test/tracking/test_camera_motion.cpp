#include "robot_vision/tracking/camera_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/video/tracking.hpp>
#include <vector>

#include "core/tracking/flow_corners.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

const cv::Matx23d kIdentity(1, 0, 0, 0, 1, 0);

/// Noise in blocks of 16 px, which has corners.
cv::Mat blocks(cv::Size size)
{
  cv::Mat image;
  cv::resize(converted(noise(size / 16, CV_8UC1), cv::COLOR_GRAY2BGR), image, size, 0.0, 0.0, cv::INTER_NEAREST);
  return image;
}

}  // namespace

TEST(FlowCorners, AreTheStrongestOfTheirCells)
{
  cv::Mat image(96, 96, CV_8UC1, cv::Scalar(20));
  image(cv::Rect(30, 24, 66, 30)).setTo(220);  // its left corners are at (30, 24) and (30, 53)
  image(cv::Rect(48, 66, 12, 12)).setTo(60);
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(image, pyramid, {11, 11}, 0, true);
  const std::vector<cv::Point2f> one = flowCorners(pyramid[1], {}, 1);
  ASSERT_EQ(one.size(), 1U);
  EXPECT_LE(std::min(cv::norm(one[0] - cv::Point2f(30, 24)), cv::norm(one[0] - cv::Point2f(30, 53))), 3.0);
  cv::Mat mask(image.size(), CV_8UC1, cv::Scalar(255));
  mask.rowRange(60, 96).setTo(0);
  const std::vector<cv::Point2f> weak = flowCorners(pyramid[1], mask, 1);
  ASSERT_EQ(weak.size(), 1U);
  EXPECT_TRUE(cv::Rect(46, 64, 16, 16).contains(weak[0]));
  EXPECT_GE(flowCorners(pyramid[1], {}, 16).size(), 4U);  // one in each cell that has any
  mask.setTo(255);
  EXPECT_TRUE(flowCorners(pyramid[1], mask, 16).empty());
}

TEST(FlowCorners, ThereAreNoneOnPlainOrStraightThings)
{
  cv::Mat image(60, 80, CV_8UC1, cv::Scalar(20));
  cv::Mat_<float> errors(image.size());
  cv::RNG random(1);
  for (const int edge : {0, 30})
  {
    image.colRange(0, edge).setTo(220);
    random.fill(errors, cv::RNG::NORMAL, 0.0, 2.0);
    cv::Mat noisy;
    cv::add(image, errors, noisy, cv::noArray(), CV_8U);
    std::vector<cv::Mat> pyramid;
    cv::buildOpticalFlowPyramid(noisy, pyramid, {11, 11}, 0, true);
    EXPECT_TRUE(flowCorners(pyramid[1], {}, 40).empty());
  }
}

TEST(CameraMotion, SurvivesAnyImageAndNeverWritesToIt)
{
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 700), cv::Size(700, 1), cv::Size(31, 33), cv::Size(33, 31),
                              cv::Size(647, 40), cv::Size(40, 647), cv::Size(321, 97)})
  {
    CameraMotion motion;
    for (const cv::Mat& image : {noise(size, CV_8UC3, 3), cv::Mat(size, CV_8UC3, cv::Scalar::all(0)),
                                 noise(size, CV_8UC3, 1), noise(size, CV_8UC3)})
    {
      const cv::Mat before = image.clone();
      const cv::Matx23d warp = motion.update(image, "bgr8", {{-5, -5, 10, 10}, {0.2, 0.2, 0.1, 1e9}});
      EXPECT_TRUE(equal(image, before));
      for (const double value : warp.val)
        EXPECT_TRUE(std::isfinite(value));
    }
  }
}

TEST(CameraMotion, AShiftIsFoundInPixelsOfTheImage)
{
  const cv::Mat around = blocks({720, 560});
  CameraMotion motion;
  EXPECT_EQ(motion.update(around(cv::Rect(20, 30, 640, 480)), "bgr8"), kIdentity);
  const cv::Matx23d warp = motion.update(around(cv::Rect(14, 38, 640, 480)), "bgr8");
  EXPECT_TRUE(motion.known());
  EXPECT_LT(cv::norm(warp - cv::Matx23d(1, 0, 6, 0, 1, -8)), 0.2);
}

TEST(CameraMotion, WhatIsAllLeftOutIsNotKnown)
{
  CameraMotion motion;
  const cv::Mat image = blocks({320, 240});
  motion.update(image, "bgr8");
  EXPECT_EQ(motion.update(image, "bgr8", {{-1e12, -1e12, 2e12, 2e12}}), kIdentity);
  EXPECT_FALSE(motion.known());
  motion.update(image, "bgr8", {{0, 0, 160, 240}});
  EXPECT_TRUE(motion.known());
}

TEST(CameraMotion, ParametersOutOfRangeAreRefused)
{
  EXPECT_EQ(refusalWith(&CameraMotionParams::width, 63), "width is 63, must be from 64 to 2048");
  EXPECT_EQ(refusalWith(&CameraMotionParams::window, 4), "window is 4, must be odd and from 5 to 51");
  EXPECT_EQ(refusalWith(&CameraMotionParams::min_points, 3), "min_points is 3, must be from 4 to 1000");
  EXPECT_EQ(refusalWith(&CameraMotionParams::min_share, std::nan("")), "min_share is nan, must be from 0.1 to 1");
}
