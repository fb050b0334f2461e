#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "robot_vision/segmentation/regions.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

const RegionParams kUncleaned{0, 1, 1};

/// A black mask with white boxes.
cv::Mat maskOf(cv::Size size, const std::vector<cv::Rect>& boxes = {})
{
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  for (const cv::Rect& box : boxes)
    mask(box).setTo(255);
  return mask;
}

std::vector<Region> find(cv::Mat mask, const RegionParams& params = kUncleaned)
{
  return RegionFinder(params).apply(mask);
}

/// The only region of a mask.
Region onlyRegion(const cv::Mat& mask, const RegionParams& params = kUncleaned)
{
  const std::vector<Region> regions = find(mask, params);
  EXPECT_EQ(regions.size(), 1U);
  return regions.empty() ? Region() : regions[0];
}

/// The pixels whose centres are in the disc.
cv::Mat disc(cv::Size size, cv::Point2d center, double radius)
{
  cv::Mat_<std::uint8_t> mask(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      mask(y, x) = std::hypot(x - center.x, y - center.y) <= radius ? 255 : 0;
  return mask;
}

/// Noise, blurred by a box of `blur` px and thresholded at its mean.
cv::Mat blobs(cv::Size size, int blur)
{
  cv::Mat soft;
  cv::blur(noise(size, CV_8UC1), soft, {blur, blur});
  return soft > 127;
}

cv::Mat cleanedByOpenCv(const cv::Mat& mask, int opening, int closing)
{
  const auto ellipse = [](int side) { return cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side}); };
  cv::Mat opened;
  cv::morphologyEx(mask, opened, cv::MORPH_OPEN, ellipse(opening));
  cv::Mat closed;
  cv::morphologyEx(opened, closed, cv::MORPH_CLOSE, ellipse(closing));
  return closed;
}

}  // namespace

TEST(RegionFinder, measuresDiscsToAFractionOfAPixel)
{
  for (const cv::Point2d center : {cv::Point2d(50, 40), cv::Point2d(50.5, 40.25), cv::Point2d(49.3, 41.7)})
    for (const double radius : {8.0, 21.4, 35.0})
    {
      const Region found = onlyRegion(disc({100, 80}, center, radius));
      EXPECT_LT(cv::norm(found.center - center), 0.15) << center << radius;
      EXPECT_LT(cv::norm(found.circle_center - center), 0.6) << center << radius;
      EXPECT_NEAR(found.area, CV_PI * radius * radius, 3.0 * radius) << center << radius;
      EXPECT_NEAR(found.circle_radius, radius, 0.5) << center << radius;
      EXPECT_GT(found.roundness, 1.0 - 1.1 / radius);  // the circle is up to half a pixel too large
      EXPECT_LE(found.roundness, 1.0);
    }
}

TEST(RegionFinder, measuresRectanglesExactly)
{
  const Region found = onlyRegion(maskOf({64, 48}, {{10, 20, 8, 5}}));
  EXPECT_EQ(found.box, cv::Rect(10, 20, 8, 5));
  EXPECT_EQ(found.center, cv::Point2d(13.5, 22.0));
  EXPECT_EQ(found.area, 40.0);
  EXPECT_NEAR(found.circle_center.x, 13.5, 1e-3);
  EXPECT_NEAR(found.circle_center.y, 22.0, 1e-3);
  EXPECT_NEAR(found.circle_radius, std::hypot(3.5, 2.0), 1e-3);  // through the centres of the corner pixels
  EXPECT_NEAR(found.roundness, 40.0 / (CV_PI * std::pow(std::hypot(3.5, 2.0) + 0.5, 2)), 1e-3);
  EXPECT_EQ(found.outline.size(), 4U);
  EXPECT_EQ(cv::boundingRect(found.outline), found.box);
}

TEST(RegionFinder, countsPixelsAsConnectedComponentsDo)
{
  // Noise has all kinds of patterns: holes, regions in holes, single pixels, lines, pixels joined at corners.
  for (const cv::Mat& mask : {blobs({160, 120}, 1), blobs({160, 120}, 3), blobs({320, 240}, 9)})
  {
    cv::Mat labels, statistics, centroids;
    const int count = cv::connectedComponentsWithStats(mask, labels, statistics, centroids);
    const std::vector<Region> regions = find(mask);
    ASSERT_EQ(regions.size(), static_cast<std::size_t>(count - 1));
    for (const Region& found : regions)
    {
      const int label = labels.at<int>(found.outline[0]);
      EXPECT_EQ(found.area, statistics.at<int>(label, cv::CC_STAT_AREA));
      EXPECT_EQ(found.box.tl(),
                cv::Point(statistics.at<int>(label, cv::CC_STAT_LEFT), statistics.at<int>(label, cv::CC_STAT_TOP)));
      EXPECT_NEAR(found.center.x, centroids.at<double>(label, 0), 1e-6);
      EXPECT_NEAR(found.center.y, centroids.at<double>(label, 1), 1e-6);
    }
  }
}

TEST(RegionFinder, doesNotCountHolesAndFindsRegionsInThem)
{
  cv::Mat mask = maskOf({80, 60}, {{10, 10, 40, 40}});
  mask(cv::Rect(15, 15, 30, 20)).setTo(0);
  mask(cv::Rect(20, 20, 6, 4)).setTo(255);
  const std::vector<Region> regions = find(mask);
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].area, 40 * 40 - 30 * 20);
  EXPECT_NEAR(regions[0].center.y, (1600 * 29.5 - 600 * 24.5) / 1000, 1e-9);
  EXPECT_EQ(regions[1].box, cv::Rect(20, 20, 6, 4));
  EXPECT_EQ(regions[1].area, 24.0);
}

TEST(RegionFinder, joinsAtCorners)
{
  cv::Mat mask = maskOf({9, 9});
  for (int i = 2; i < 7; ++i)
    mask.at<std::uint8_t>(i, i) = 255;
  const Region found = onlyRegion(mask);
  EXPECT_EQ(found.area, 5.0);
  EXPECT_EQ(found.center, cv::Point2d(4, 4));
}

TEST(RegionFinder, sortsByAreaAndLeavesOutSmallOnes)
{
  const cv::Mat mask = maskOf({100, 50}, {{5, 5, 10, 10}, {30, 5, 11, 10}, {60, 5, 9, 11}, {5, 30, 80, 1}});
  const std::vector<Region> regions = find(mask, {99, 1, 1});
  ASSERT_EQ(regions.size(), 3U);
  EXPECT_EQ(regions[0].area, 110.0);
  EXPECT_EQ(regions[1].area, 100.0);
  EXPECT_EQ(regions[2].area, 99.0);
}

TEST(RegionFinder, cleansAsOpenCvDoesOnTheWholeMask)
{
  for (const auto& [opening, closing] : {std::pair(3, 3), std::pair(1, 5), std::pair(5, 1), std::pair(7, 15)})
    for (const cv::Rect& part : {cv::Rect(0, 0, 120, 90), cv::Rect(20, 17, 60, 50), cv::Rect(90, 1, 29, 20)})
    {
      cv::Mat mask = maskOf({120, 90});
      blobs(part.size(), 5).copyTo(mask(part));
      const cv::Mat expected = cleanedByOpenCv(mask, opening, closing);
      RegionFinder({0, opening, closing}).apply(mask);
      EXPECT_TRUE(equal(mask, expected)) << opening << " " << closing << " " << part;
    }
}

TEST(RegionFinder, looksOnlyAtTheGivenPart)
{
  cv::Mat mask = maskOf({150, 60}, {{70, 20, 24, 20}, {100, 25, 12, 10}});
  for (const int diameter : {1, 3, 9})  // the closing by 9 joins them, and reaches beyond
  {
    const RegionFinder finder({0, 1, diameter});
    cv::Mat whole = mask.clone(), part = mask.clone();
    const std::vector<Region> expected = finder.apply(whole), found = finder.apply(part, {70, 20, 42, 20});
    EXPECT_TRUE(equal(part, whole)) << diameter;
    ASSERT_EQ(found.size(), expected.size()) << diameter;
    for (std::size_t i = 0; i < found.size(); ++i)
    {
      EXPECT_EQ(found[i].box, expected[i].box) << diameter;
      EXPECT_EQ(found[i].area, expected[i].area) << diameter;
      EXPECT_EQ(found[i].outline, expected[i].outline) << diameter;
    }
  }
  const RegionFinder finder({0, 1, 1});
  EXPECT_EQ(finder.apply(mask, {100, 0, 50, 60}).size(), 1U);  // the region outside of the part is not found
  EXPECT_TRUE(finder.apply(mask, {}).empty());
}

TEST(RegionFinder, removesSpecksAndFillsGaps)
{
  // A gap is between the two boxes, and a speck beside them.
  const cv::Mat mask = maskOf({60, 60}, {{10, 10, 15, 30}, {26, 10, 14, 30}, {50, 50, 2, 2}});
  EXPECT_EQ(onlyRegion(mask, {0, 3, 3}).box, cv::Rect(10, 10, 30, 30));
}

TEST(RegionFinder, takesBlackAndWhiteMasks)
{
  const RegionFinder finder({0, 3, 3});
  cv::Mat full(30, 40, CV_8UC1, cv::Scalar(255));
  ASSERT_EQ(finder.apply(full).size(), 1U);
  cv::Mat empty = maskOf({40, 30});
  EXPECT_TRUE(finder.apply(empty).empty());
  cv::Mat pixel(1, 1, CV_8UC1, cv::Scalar(255));
  const std::vector<Region> regions = finder.apply(pixel);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].area, 1.0);
  EXPECT_EQ(regions[0].center, cv::Point2d(0, 0));
  EXPECT_EQ(regions[0].roundness, 1.0);
  EXPECT_EQ(regions[0].circle_radius, 0.0);
}

TEST(RegionFinder, ignoresPixelsAroundTheMask)
{
  cv::Mat large(60, 80, CV_8UC1, cv::Scalar(255));
  cv::Mat mask = large(cv::Rect(20, 20, 40, 30));
  mask.setTo(0);
  mask(cv::Rect(0, 0, 10, 10)).setTo(255);
  EXPECT_EQ(onlyRegion(mask, {0, 3, 3}).box, cv::Rect(0, 0, 10, 10));
  EXPECT_EQ(cv::countNonZero(large), 60 * 80 - 40 * 30 + cv::countNonZero(mask));
}

TEST(RegionFinder, refusesEmptyAndColoredMasks)
{
  EXPECT_THROW(find(cv::Mat()), std::invalid_argument);
  EXPECT_THROW(find(cv::Mat(4, 4, CV_8UC3)), std::invalid_argument);
}

TEST(RegionFinder, refusesParametersOutOfRange)
{
  EXPECT_EQ(refusal([] { RegionFinder{RegionParams{1, 0, 3}}; }), "opening is 0, must be odd and from 1 to 31");
}
