#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/dnn/suppression.hpp"

using namespace robot_vision;

namespace
{

constexpr double kTurn = 2 * CV_PI;

Candidate turned(double x, double y, double width, double height, double angle)
{
  return {1.0F, 0, 0, {x - width / 2, y - height / 2, x + width / 2, y + height / 2}, angle};
}

double shared(const Candidate& a, const Candidate& b)
{
  return sharedArea(outlineOf(a), outlineOf(b));
}

double byOpenCv(const Candidate& a, const Candidate& b)
{
  std::vector<cv::Point2f> outlines[2], both;
  for (const cv::Point2d& corner : outlineOf(a))
    outlines[0].emplace_back(corner);
  for (const cv::Point2d& corner : outlineOf(b))
    outlines[1].emplace_back(corner);
  return cv::intersectConvexConvex(outlines[0], outlines[1], both);
}

}  // namespace

TEST(Suppression, outlineGoesClockwiseFromTheTopLeft)
{
  const BoxOutline straight = outlineOf(turned(10, 20, 6, 4, 0.0));
  const cv::Point2d expected[] = {{7, 18}, {13, 18}, {13, 22}, {7, 22}};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LT(cv::norm(straight[i] - expected[i]), 1e-12);
  const BoxOutline quarter = outlineOf(turned(10, 20, 6, 4, CV_PI / 2));  // from x towards y
  EXPECT_LT(cv::norm(quarter[0] - cv::Point2d(12, 17)), 1e-12);
}

TEST(Suppression, sharedAreaIsWhatIsKnownOfSimpleBoxes)
{
  const Candidate square = turned(0, 0, 2, 2, 0.0);
  EXPECT_NEAR(shared(square, square), 4.0, 1e-12);
  EXPECT_NEAR(shared(square, turned(1, 0, 2, 2, 0.0)), 2.0, 1e-12);
  EXPECT_NEAR(shared(square, turned(0, 0, 2, 2, CV_PI / 4)), 8.0 * (std::sqrt(2.0) - 1.0), 1e-12);  // an octagon
  EXPECT_NEAR(shared(square, turned(0, 0, 1, 1, 0.4)), 1.0, 1e-12);
  EXPECT_EQ(shared(square, turned(5, 0, 2, 2, 0.3)), 0.0);
  EXPECT_NEAR(shared(square, turned(2, 0, 2, 2, 0.0)), 0.0, 1e-12);
  EXPECT_NEAR(shared(square, turned(0, 0, 2, 2, 7 * kTurn)), 4.0, 1e-9);
}

TEST(Suppression, sharedAreaIsThatOfOpenCvAndTheSameBothWays)
{
  cv::RNG random(5);
  const auto any = [&random]
  {
    return turned(random.uniform(0.0, 30.0), random.uniform(0.0, 30.0), random.uniform(1.0, 40.0),
                  random.uniform(1.0, 40.0), random.uniform(-kTurn, kTurn));
  };
  for (int i = 0; i < 2000; ++i)
  {
    const Candidate a = any(), b = any();
    EXPECT_NEAR(shared(a, b), byOpenCv(a, b), 0.02);
    EXPECT_NEAR(shared(a, b), shared(b, a), 1e-8);
  }
}

TEST(Suppression, sharedAreaOfBoxesFarAwayAndVeryThinIsFinite)
{
  for (const double far : {0.0, 1e6, 1e20, 1e38})
    for (const double thin : {1e-30, 1e-3, 1.0, 1e38})
    {
      const double area = shared(turned(far, -far, thin, 5, 0.7), turned(far, -far, 5, thin, 0.2));
      EXPECT_TRUE(std::isfinite(area) && area >= 0.0) << far << " " << thin << ": " << area;
    }
}
