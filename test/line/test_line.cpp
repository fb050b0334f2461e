#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "robot_vision/line/line.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr double kDegree = CV_PI / 180.0;
const cv::Size kStrip(320, 60);
const cv::Point2d kMiddle((kStrip.width - 1) / 2.0, (kStrip.height - 1) / 2.0);

/// A mask of a band through `center`, whose direction is `angle` clockwise from straight up.
cv::Mat band(const cv::Point2d& center, double angle, double width)
{
  cv::Mat_<std::uint8_t> mask(kStrip);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
    {
      const double off = (x - center.x) * std::cos(angle) + (y - center.y) * std::sin(angle);
      mask(y, x) = std::abs(off) <= width / 2.0 ? 255 : 0;
    }
  return mask;
}

Line lineAt(double x)
{
  return findLine(band({x, kMiddle.y}, 0.0, 20.0));
}

}  // namespace

TEST(Line, isExactForAnUprightBar)
{
  cv::Mat mask = cv::Mat::zeros(kStrip, CV_8UC1);
  mask(cv::Rect(200, 0, 41, 60)) = 255;
  const Line line = findLine(mask);
  EXPECT_TRUE(line.found);
  EXPECT_EQ(line.center, cv::Point2d(220.0, 29.5));
  EXPECT_DOUBLE_EQ(line.offset, 220.0 - 159.5);
  EXPECT_DOUBLE_EQ(line.error, (220.0 - 159.5) / 160.0);
  EXPECT_DOUBLE_EQ(line.angle, 0.0);
  EXPECT_DOUBLE_EQ(line.area, 41.0 * 60.0);
  EXPECT_DOUBLE_EQ(line.confidence, 2460.0 / (2460.0 + 100.0));
  EXPECT_EQ(cv::boundingRect(line.outline), cv::Rect(200, 0, 41, 60));
}

TEST(Line, hasTheAngleAndTheCenterOfTheBand)
{
  for (const double width : {6.0, 20.0, 40.0})
    for (int degrees = -60; degrees <= 60; degrees += 5)
      for (const double x : {kMiddle.x, 130.0, 201.3})
      {
        const Line line = findLine(band({x, kMiddle.y}, degrees * kDegree, width));
        const bool whole = std::abs(x - kMiddle.x) < 20 || std::abs(degrees) < 45;
        if (!whole) continue;
        EXPECT_NEAR(line.angle, degrees * kDegree, 0.5 * kDegree) << width << " px, " << degrees << " degrees";
        EXPECT_NEAR(line.center.x, x, 0.5) << width << " px, " << degrees << " degrees";
        EXPECT_NEAR(line.center.y, kMiddle.y, 0.5);
        EXPECT_NEAR(line.confidence, line.area / (line.area + 100.0), 0.02);
      }
}

TEST(Line, hasTheAngleOfABandThatLeavesAtTheSide)
{
  for (const double degrees : {-90.0, -88.0, -80.0, -70.0, 50.0, 70.0, 80.0, 88.0, 90.0})
    for (const double x : {kMiddle.x, 20.0, 300.0})
    {
      const Line line = findLine(band({x, kMiddle.y}, degrees * kDegree, 20.0));
      // Straight to the left and straight to the right look the same.
      const double difference = std::remainder(line.angle - degrees * kDegree, CV_PI);
      EXPECT_NEAR(difference, 0.0, 1.0 * kDegree) << degrees << " degrees at " << x;
      if (std::abs(degrees) > 85.0) EXPECT_NEAR(line.confidence, line.area / (line.area + 100.0), 0.02);
    }
}

TEST(Line, hasTheAngleOfAPieceInTheMiddle)
{
  cv::Mat mask = cv::Mat::zeros(kStrip, CV_8UC1);
  mask(cv::Rect(100, 20, 90, 12)) = 255;
  EXPECT_DOUBLE_EQ(std::abs(findLine(mask).angle), CV_PI / 2.0);
  mask = 0;
  mask(cv::Rect(100, 5, 12, 50)) = 255;
  EXPECT_DOUBLE_EQ(findLine(mask).angle, 0.0);
}

TEST(Line, isConnectedAtTheCornersOfItsPixels)
{
  cv::Mat mask = cv::Mat::zeros(kStrip, CV_8UC1);
  for (int y = 0; y < kStrip.height; ++y)
    mask.at<std::uint8_t>(y, 130 - y) = 255;
  const Line line = findLine(mask, {1.0 * kStrip.height});
  EXPECT_DOUBLE_EQ(line.area, kStrip.height);
  EXPECT_DOUBLE_EQ(line.angle, CV_PI / 4.0);
}

TEST(Line, isNotMovedBySpecklesAndSmallerRegions)
{
  const Line alone = lineAt(100.0);
  cv::Mat mask = band({100.0, kMiddle.y}, 0.0, 20.0);
  mask(cv::Rect(250, 10, 20, 30)) = 255;
  cv::RNG random(7);
  for (int i = 0; i < 300; ++i)
    mask.at<std::uint8_t>(random.uniform(0, 60), random.uniform(120, 320)) = 255;
  const Line line = findLine(mask);
  EXPECT_EQ(line.center, alone.center);
  EXPECT_EQ(line.angle, alone.angle);
  EXPECT_EQ(line.area, alone.area);
  EXPECT_LT(line.confidence, 0.7 * alone.confidence);
}

TEST(Line, isChosenNearThePreviousOne)
{
  cv::Mat mask = band({100.0, kMiddle.y}, 0.0, 20.0);
  mask |= band({240.0, kMiddle.y}, 0.0, 30.0);
  EXPECT_NEAR(findLine(mask).center.x, 240.0, 0.5);
  EXPECT_NEAR(findLine(mask, {}, lineAt(110.0)).center.x, 100.0, 0.5);
  EXPECT_NEAR(findLine(mask, {}, lineAt(230.0)).center.x, 240.0, 0.5);
  EXPECT_NEAR(findLine(mask, {}, Line()).center.x, 240.0, 0.5) << "a line that was not found does not count";
}

TEST(Line, hasHalfTheScoreAnEighthOfTheWidthFromThePreviousOne)
{
  // One region is where the line was, another an eighth of the width to the right of it.
  const Line previous = lineAt(100.0);
  for (const int width : {36, 44})  // twice the area of 20 x 60 lies between
  {
    cv::Mat mask = band(previous.center, 0.0, 20.0);
    const int left = static_cast<int>(std::lround(previous.center.x)) + 40 - width / 2;
    mask(cv::Rect(left, 0, width, 60)) = 255;
    mask.col(left - 1) = 0;
    const Line line = findLine(mask, {}, previous);
    EXPECT_EQ(line.center.x > previous.center.x + 20.0, width == 44) << width;
  }
}

TEST(Line, isMirroredWithTheMask)
{
  for (const double degrees : {0.0, 20.0, 55.0, 80.0})
  {
    const cv::Mat mask = band({120.0, kMiddle.y}, degrees * kDegree, 24.0);
    cv::Mat mirrored;
    cv::flip(mask, mirrored, 1);
    const Line line = findLine(mask), other = findLine(mirrored);
    EXPECT_NEAR(other.offset, -line.offset, 1e-9) << degrees;
    EXPECT_NEAR(other.angle, -line.angle, 1e-9) << degrees;
    EXPECT_NEAR(other.confidence, line.confidence, 1e-9);
  }
}

TEST(Line, isNotFoundBelowMinArea)
{
  cv::Mat mask = cv::Mat::zeros(kStrip, CV_8UC1);
  EXPECT_FALSE(findLine(mask).found);
  mask(cv::Rect(30, 20, 11, 9)) = 1;  // any value but 0 is line
  const Line none = findLine(mask);
  EXPECT_FALSE(none.found);
  EXPECT_EQ(none.offset, 0.0);
  EXPECT_EQ(none.confidence, 0.0);
  EXPECT_TRUE(none.outline.empty());
  EXPECT_TRUE(findLine(mask, {99}).found);
  EXPECT_DOUBLE_EQ(findLine(mask, {99}).confidence, 0.5);
}

TEST(Line, hasLittleConfidenceInWhiteMasksAndBentRegions)
{
  for (const cv::Point& border : {cv::Point(0, 0), cv::Point(1, 0), cv::Point(0, 1), cv::Point(8, 3)})  // as of a lens
  {
    cv::Mat floor = cv::Mat::zeros(kStrip, CV_8UC1);
    const cv::Rect inner(border.x, border.y, kStrip.width - 2 * border.x, kStrip.height - 2 * border.y);
    floor(inner) = 255;
    EXPECT_EQ(findLine(floor).confidence, 0.0) << border;
  }

  const cv::Mat straight = band(kMiddle, 0.0, 12.0);
  cv::Mat zigzag = cv::Mat::zeros(kStrip, CV_8UC1);
  for (int y = 0; y < kStrip.height; ++y)
    zigzag(cv::Rect(120 + std::abs(y - 30) * 2, y, 12, 1)) = 255;
  EXPECT_LT(findLine(zigzag).confidence, 0.5 * findLine(straight).confidence);
  EXPECT_NEAR(findLine(zigzag).angle, 0.0, 5.0 * kDegree);
}

TEST(Line, hasTheOutlineOfItsRegion)
{
  const cv::Mat mask = band({90.0, 20.0}, 30.0 * kDegree, 30.0);
  cv::Mat speckled = mask.clone(), filled = cv::Mat::zeros(kStrip, CV_8UC1);
  speckled.at<std::uint8_t>(5, 300) = 255;
  cv::fillPoly(filled, std::vector<std::vector<cv::Point>>{findLine(speckled).outline}, 255);
  EXPECT_TRUE(equal(filled, mask));
}

TEST(Line, isFoundInPaddedAndTinyMasks)
{
  const cv::Mat mask = band({90.0, 20.0}, 30.0 * kDegree, 30.0);
  cv::Mat wide(kStrip.height, kStrip.width + 13, CV_8UC1, cv::Scalar(255));
  cv::Mat padded = wide.colRange(0, kStrip.width);
  mask.copyTo(padded);
  const cv::Mat before = wide.clone();
  EXPECT_EQ(findLine(padded).center, findLine(mask).center);
  EXPECT_EQ(findLine(padded).angle, findLine(mask).angle);
  EXPECT_TRUE(equal(wide, before));

  const Line pixel = findLine(cv::Mat(1, 1, CV_8UC1, cv::Scalar(255)), {1});
  EXPECT_TRUE(pixel.found);
  EXPECT_EQ(pixel.offset, 0.0);
  EXPECT_EQ(pixel.angle, 0.0);
}

TEST(Line, refusesEmptyMasksAndOtherTypes)
{
  EXPECT_THROW(findLine(cv::Mat()), std::invalid_argument);
  EXPECT_THROW(findLine(cv::Mat(4, 4, CV_8UC3)), std::invalid_argument);
  EXPECT_THROW(findLine(cv::Mat(4, 4, CV_16UC1)), std::invalid_argument);
}

TEST(Line, refusesParametersOutOfRange)
{
  EXPECT_EQ(refusal([] { findLine(cv::Mat(4, 4, CV_8UC1), {2e9}); }), "min_area is 2e+09, must be from 1 to 1e+09");
}
