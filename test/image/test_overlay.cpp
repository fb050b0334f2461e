#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgproc.hpp>

#include "robot_vision/image/overlay.hpp"
#include "support/images.hpp"

using namespace robot_vision;

namespace
{

const cv::Vec3b kGray(90, 90, 90), kGreen(0, 255, 0), kRed(0, 0, 255), kYellow(0, 255, 255);

cv::Mat3b grayImage(cv::Size size = {200, 160})
{
  return {size, kGray};
}

/// The number of pixels that are not gray any more.
int drawn(const cv::Mat3b& image)
{
  cv::Mat same;
  cv::inRange(image, kGray, kGray, same);
  return static_cast<int>(same.total()) - cv::countNonZero(same);
}

/// The number of whole degrees at which the image is not gray any more along a circle.
int drawnAlongCircle(const cv::Mat3b& image, const cv::Point2d& center, double radius)
{
  int count = 0;
  for (int degree = 0; degree < 360; ++degree)
  {
    const double angle = degree * CV_PI / 180.0;
    count += image(cv::Point(center + radius * cv::Point2d(std::cos(angle), std::sin(angle)))) != kGray;
  }
  return count;
}

}  // namespace

TEST(Masking, keepsThePixelsInTheMask)
{
  const cv::Mat bgr = noise({61, 47}, CV_8UC3, 3), before = bgr.clone();
  cv::Mat mask = noise(bgr.size(), CV_8UC1, 5);
  mask.setTo(0, mask < 128);  // all values but 0 belong to the mask
  std::vector<std::uint8_t> memory(47 * 200, 77);
  cv::Mat out(47, 61, CV_8UC3, memory.data(), 200);
  maskPicture(bgr, mask, out);
  EXPECT_EQ(out.data, memory.data());
  EXPECT_EQ(memory[61 * 3], 77);  // the padding of the first row
  EXPECT_TRUE(equal(bgr, before));
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      ASSERT_EQ(out.at<cv::Vec3b>(y, x), mask.at<std::uint8_t>(y, x) ? bgr.at<cv::Vec3b>(y, x) : cv::Vec3b());
}

TEST(Masking, refusesOtherTypesAndSizes)
{
  const cv::Mat bgr(4, 5, CV_8UC3, cv::Scalar::all(1));
  cv::Mat out;
  EXPECT_THROW(maskPicture(bgr, cv::Mat(4, 4, CV_8UC1, cv::Scalar(1)), out), std::invalid_argument);
  EXPECT_THROW(maskPicture(bgr, bgr, out), std::invalid_argument);
  EXPECT_THROW(maskPicture(cv::Mat(), cv::Mat(), out), std::invalid_argument);
  EXPECT_THROW(maskPicture(cv::Mat(4, 5, CV_8UC1), cv::Mat(4, 5, CV_8UC1), out), std::invalid_argument);
}

TEST(DrawOutline, drawsThePolygonAndItsLabel)
{
  cv::Mat3b image = grayImage();
  const std::vector<cv::Point> square = {{60, 60}, {140, 60}, {140, 120}, {60, 120}};
  drawOutline(image, square, "");
  const cv::Mat3b without = image.clone();
  for (const cv::Point& point : {cv::Point(60, 90), cv::Point(100, 60), cv::Point(140, 90), cv::Point(100, 120)})
    EXPECT_EQ(image(point), kGreen) << point;
  EXPECT_EQ(drawn(image(cv::Rect(65, 65, 70, 50))), 0);

  drawOutline(image, square, "blue", {255, 0, 0});
  EXPECT_EQ(image(90, 60), cv::Vec3b(255, 0, 0));
  EXPECT_GT(drawn(image(cv::Rect(60, 35, 60, 22))), 50);
  EXPECT_EQ(drawn(image(cv::Rect(0, 125, 200, 35))), 0);
}

TEST(DrawOutline, keepsTheLabelInsideOfTheImage)
{
  const auto labelOf = [](const cv::Rect& box)
  {
    cv::Mat3b with = grayImage(), without = grayImage();
    const cv::Point far = box.br();
    const std::vector<cv::Point> outline = {box.tl(), {far.x, box.y}, far, {box.x, far.y}};
    drawOutline(with, outline, "label");
    drawOutline(without, outline, "");
    cv::Mat changed;
    cv::cvtColor(with != without, changed, cv::COLOR_BGR2GRAY);
    return cv::boundingRect(changed);
  };
  const cv::Rect whole = labelOf({60, 60, 60, 60});
  EXPECT_LT(whole.br().y, 61);
  EXPECT_GT(labelOf({60, 2, 60, 60}).y, 61);  // no room above
  for (const cv::Rect& box : {cv::Rect(60, 2, 60, 60), cv::Rect(180, 60, 15, 60), cv::Rect(-30, 60, 60, 60),
                              cv::Rect(170, 0, 25, 159), cv::Rect(-5, 150, 60, 60), cv::Rect(60, -70, 60, 60)})
  {
    EXPECT_NEAR(labelOf(box).width, whole.width, 3) << box;
    EXPECT_NEAR(labelOf(box).height, whole.height, 4) << box;
  }
}

TEST(DrawBall, drawsACircleAroundTheBall)
{
  const cv::Point2d center(100.4, 80.3);
  cv::Mat3b image = grayImage();
  drawBall(image, center, 50.0);
  EXPECT_EQ(image(cv::Point(center)), kRed);
  EXPECT_EQ(image(80, 150), kYellow);
  EXPECT_EQ(drawnAlongCircle(image, center, 50.0), 360);
  EXPECT_EQ(drawnAlongCircle(image, center, 45.0), 0);
  EXPECT_EQ(drawnAlongCircle(image, center, 55.0), 0);
}

TEST(DrawBall, dashesAPrediction)
{
  const cv::Point2d center(100.4, 80.3);
  cv::Mat3b measured = grayImage(), predicted = grayImage();
  drawBall(measured, center, 50.0);
  drawBall(predicted, center, 50.0, true);
  EXPECT_NEAR(drawnAlongCircle(predicted, center, 50.0), 180, 40);
  EXPECT_LT(drawn(predicted), drawn(measured) / 2);
}

TEST(DrawTrail, growsTowardsTheNewest)
{
  cv::Mat3b image = grayImage();
  std::vector<cv::Point2d> centers;
  for (int x = 10; x <= 190; x += 10)
    centers.emplace_back(x, 80);
  drawTrail(image, centers);
  const int oldest = drawn(image.col(15)), middle = drawn(image.col(95)), newest = drawn(image.col(185));
  EXPECT_GE(oldest, 1);
  EXPECT_LT(oldest, middle);
  EXPECT_LT(middle, newest);
  EXPECT_LE(newest, 9);
  EXPECT_EQ(image(80, 185), kRed);
}

TEST(DrawTrail, isInterruptedByACenterThatIsNotFinite)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  cv::Mat3b image = grayImage();
  drawTrail(image, {{10, 80}, {50, 80}, {nan, nan}, {150, 80}, {190, 80}});
  EXPECT_GT(drawn(image.col(30)), 0);
  EXPECT_EQ(drawn(image.col(100)), 0);
  EXPECT_GT(drawn(image.col(170)), 0);
}

TEST(Drawing, ignoresEmptyInfiniteAndFarAwayShapes)
{
  const double inf = std::numeric_limits<double>::infinity();
  cv::Mat3b image = grayImage();
  drawTrail(image, {});
  drawTrail(image, {{5, 5}});
  drawTrail(image, {{inf, 0}, {1e300, -1e300}, {-inf, inf}});
  drawOutline(image, {}, "nothing");
  for (const cv::Point2d& center : {cv::Point2d(inf, 0), cv::Point2d(1e12, 0), cv::Point2d(-5000, 9000)})
    for (const bool predicted : {false, true})
      drawBall(image, center, 20.0, predicted);
  drawBall(image, {50, 50}, inf);
  drawBall(image, {50, 50}, -1.0);
  EXPECT_EQ(drawn(image), 0);
  cv::Mat3b tiny(1, 1, kGray);
  drawOutline(tiny, {{0, 0}}, "label");
  drawBall(tiny, {0, 0}, 1e4);
  EXPECT_EQ(tiny.size(), cv::Size(1, 1));
}

TEST(Drawing, refusesImagesWithoutColor)
{
  cv::Mat gray(4, 5, CV_8UC1, cv::Scalar(9));
  EXPECT_THROW(drawBall(gray, {1, 1}, 1), std::invalid_argument);
  EXPECT_THROW(drawTrail(gray, {}), std::invalid_argument);
  EXPECT_THROW(drawOutline(gray, {}, ""), std::invalid_argument);
}
