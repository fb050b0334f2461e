#include <gtest/gtest.h>

#include "robot_vision/skeleton/skeleton.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// A gray image that is black but for the last quarter of its rows, which have this value.
cv::Mat imageWithBand(int value)
{
  cv::Mat image(40, 30, CV_8UC1, cv::Scalar(0));
  image.rowRange(30, 40).setTo(value);
  return image;
}

}  // namespace

TEST(Skeleton, countsPixelsAboveTheThreshold)
{
  EXPECT_EQ(measureSkeleton(imageWithBand(129), "mono8"), 0.25);
  EXPECT_EQ(measureSkeleton(imageWithBand(128), "mono8"), 0.0);
}

TEST(Skeleton, refusesParametersOutOfRange)
{
  SkeletonParams params;
  params.threshold = 256.0;
  EXPECT_EQ(refusal([&] { validate(params); }), "threshold is 256, must be from 0 to 255");
}
