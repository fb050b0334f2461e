#include "core/tags/pose/blurred_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "robot_vision/tags/detection/tag_families.hpp"

using namespace robot_vision;

namespace
{

struct Blur
{
  cv::Point2d point, sigma;
  double correlation;
};

/// The shares of white and known cells, by a sum over the points of a correlated normal distribution.
cv::Vec2d summedShares(const cv::Mat& cells, const Blur& blur)
{
  constexpr int kSteps = 400;
  constexpr double kReach = 6.0;  // sigmas
  const double rest = std::sqrt(1.0 - blur.correlation * blur.correlation);
  cv::Vec2d sums;
  double all = 0.0;
  for (int i = 0; i < kSteps; ++i)
    for (int k = 0; k < kSteps; ++k)
    {
      const double u = ((i + 0.5) / kSteps * 2.0 - 1.0) * kReach, v = ((k + 0.5) / kSteps * 2.0 - 1.0) * kReach;
      const double weight = std::exp(-(u * u + v * v) / 2.0);
      all += weight;
      const int x = cvFloor(blur.point.x + blur.sigma.x * u);
      const int y = cvFloor(blur.point.y + blur.sigma.y * (blur.correlation * u + rest * v));
      if (x < 0 || y < 0 || x >= cells.cols || y >= cells.rows) continue;
      const uchar cell = cells.at<uchar>(y, x);
      sums += weight * cv::Vec2d(cell == 255 ? 1.0 : 0.0, cell != kFreeCell ? 1.0 : 0.0);
    }
  return sums / all;
}

std::vector<Blur> randomBlurs(const cv::Mat& cells, double max_correlation)
{
  cv::RNG random(31);
  std::vector<Blur> found;
  for (int i = 0; i < 60; ++i)
    found.push_back({{random.uniform(-0.7, cells.cols + 0.7), random.uniform(-0.7, cells.rows + 0.7)},
                     {random.uniform(0.05, 0.8), random.uniform(0.05, 0.8)},
                     random.uniform(-max_correlation, max_correlation)});
  return found;
}

double changeOf(const std::function<BlurredArea(double)>& area, double step)
{
  return (area(step).share - area(-step).share) / (2.0 * step);
}

}  // namespace

TEST(BlurredGrid, sharesAreThoseOfTheNormalDistribution)
{
  for (const char* family : {"tag16h5", "tagCustom48h12", "tagCircle21h7"})
  {
    const cv::Mat cells = tagCells(family, 7);
    const BlurredGrid blurred(cells);
    for (const Blur& blur : randomBlurs(cells, 0.5))
    {
      const BlurredPoint point = blurred.at(blur.point, blur.sigma, blur.correlation);
      const cv::Vec2d expected = summedShares(cells, blur);
      EXPECT_NEAR(point.white.share, expected[0], 0.01) << family << blur.point;
      EXPECT_NEAR(point.known.share, expected[1], 0.01) << family << blur.point;
    }
  }
}

TEST(BlurredGrid, derivativesAreThoseOfTheShares)
{
  constexpr double kStep = 1e-4;  // cells
  for (const char* family : {"tag16h5", "tagCustom48h12"})
  {
    const cv::Mat cells = tagCells(family, 7);
    const BlurredGrid blurred(cells);
    for (const Blur& blur : randomBlurs(cells, 0.3))
      for (BlurredArea BlurredPoint::*area : {&BlurredPoint::white, &BlurredPoint::known})
      {
        const auto at = [&](cv::Point2d point, cv::Point2d sigma)
        { return blurred.at(blur.point + point, blur.sigma + sigma, blur.correlation).*area; };
        const BlurredArea here = at({}, {});
        // The series of the derivatives has one term less than that of the share.
        const double min_sigma = std::min(blur.sigma.x, blur.sigma.y);
        const double c = std::abs(blur.correlation), allowed = (0.002 + c * c * c) / min_sigma;
        EXPECT_NEAR(here.by_point[0], changeOf([&](double d) { return at({d, 0}, {}); }, kStep), allowed);
        EXPECT_NEAR(here.by_point[1], changeOf([&](double d) { return at({0, d}, {}); }, kStep), allowed);
        EXPECT_NEAR(here.by_sigma[0], changeOf([&](double d) { return at({}, {d, 0}); }, kStep), allowed);
        const auto turned = [&](double d) { return blurred.at(blur.point, blur.sigma, blur.correlation + d).*area; };
        EXPECT_NEAR(here.by_correlation, changeOf(turned, kStep), 0.002);
        EXPECT_NEAR(here.by_sigma[1], changeOf([&](double d) { return at({}, {0, d}); }, kStep), allowed);
      }
  }
}

TEST(BlurredGrid, derivativesAreExactWithoutCorrelation)
{
  constexpr double kStep = 1e-4;  // cells
  const cv::Mat cells = tagCells("tag36h11", 3);
  const BlurredGrid blurred(cells);
  for (const Blur& blur : randomBlurs(cells, 0.0))
  {
    const auto white = [&](double x, double sigma)
    { return blurred.at(blur.point + cv::Point2d(x, 0.0), blur.sigma + cv::Point2d(sigma, 0.0), 0.0).white; };
    const BlurredArea here = white(0.0, 0.0);
    EXPECT_NEAR(here.by_point[0], changeOf([&](double d) { return white(d, 0.0); }, kStep), 5e-3);
    EXPECT_NEAR(here.by_sigma[0], changeOf([&](double d) { return white(0.0, d); }, kStep), 5e-3);
  }
}

TEST(BlurredGrid, sharesAreZeroFarFromTheCells)
{
  const BlurredGrid blurred(tagCells("tag36h11", 3));
  const BlurredPoint far = blurred.at({-40.0, 300.0}, {0.5, 0.5}, 0.2);
  EXPECT_EQ(far.white.share, 0.0);
  EXPECT_EQ(far.known.share, 0.0);
  EXPECT_EQ(cv::norm(far.white.by_point) + cv::norm(far.known.by_sigma), 0.0);
}
