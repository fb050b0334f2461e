#include "core/image/conversion_buffer.hpp"

#include <gtest/gtest.h>

#include "support/images.hpp"

using namespace robot_vision;

TEST(ConversionBuffer, convertsIntoTheSameMemory)
{
  ConversionBuffer buffer;
  const cv::Mat bgr = smooth({64, 48});
  const cv::Mat first = buffer.gray(bgr, "bgr8");
  EXPECT_TRUE(equal(first, converted(bgr, "bgr8", "mono8")));
  EXPECT_EQ(buffer.gray(bgr, "bgr8").data, first.data);
  EXPECT_TRUE(equal(buffer.bgr(bgr, "bgr8"), bgr));
}

TEST(ConversionBuffer, neitherKeepsNorWritesAnImageThatNeedsNoConversion)
{
  ConversionBuffer buffer;
  const cv::Mat gray = noise({64, 48}, CV_8UC1), before = gray.clone();
  EXPECT_EQ(buffer.gray(gray, "mono8").data, gray.data);
  EXPECT_EQ(gray.u->refcount, 1);
  buffer.gray(smooth({64, 48}), "bgr8");
  EXPECT_TRUE(equal(gray, before));
}

TEST(ConversionBuffer, whatIsDetachedStaysAsItIs)
{
  ConversionBuffer buffer;
  const cv::Mat bgr = smooth({64, 48}), black(48, 64, CV_8UC3, cv::Scalar::all(0));
  const cv::Mat converted = buffer.gray(bgr, "bgr8");
  const cv::Mat detached = buffer.detach(converted), before = converted.clone();
  EXPECT_EQ(detached.data, converted.data);
  buffer.gray(black, "bgr8");
  EXPECT_TRUE(equal(detached, before));
  const cv::Mat gray = before.clone();
  EXPECT_NE(buffer.detach(buffer.gray(gray, "mono8")).data, gray.data);
}
