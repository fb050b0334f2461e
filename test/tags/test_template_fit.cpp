#include "core/tags/pose/template_fit.hpp"

#include <gtest/gtest.h>

#include <map>

#include "support/found_tags.hpp"

using namespace robot_vision;

namespace
{

using Corners = std::array<cv::Point2d, 4>;

Pattern patternOf(const std::string& family, int id)
{
  const TagFamily& facts = tagFamily(family);
  return {tagCells(family, id), (facts.width - facts.width_at_border) / 2};
}

View viewOf(const Corners& corners, const Pattern& pattern, double blur)
{
  View view{toPattern(corners, pattern), {}};
  view.looks[kBlur] = blur;
  view.looks[kBlack] = 30.0;
  view.looks[kBlack + 1] = 6.0;
  view.looks[kBlack + 2] = -9.0;
  view.looks[kContrast] = 170.0;
  view.looks[kContrast + 1] = 12.0;
  view.looks[kContrast + 2] = 5.0;
  view.looks[kAround] = 90.0;
  return view;
}

/// Places about the edges of a tag, of which the view itself tells the level, and some noise.
std::vector<GreySample> samplesOf(const Pattern& pattern, const View& view, double noise, cv::RNG& random)
{
  const BlurredGrid cells(pattern.cells);
  const cv::Matx33d to_picture = view.H.inv();
  std::vector<GreySample> samples;
  while (samples.size() < 320)
  {
    const cv::Point2d q(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5));
    const cv::Point2d place = mapped(to_picture, q).point;
    Unknowns jacobian;
    const double level = levelAt(cells, pattern.cells.cols, view, place, jacobian);
    const bool is_near_edge = std::abs(jacobian[0]) + std::abs(jacobian[3]) > 20.0;
    if (is_near_edge) samples.push_back({place, level + random.gaussian(noise)});
  }
  return samples;
}

}  // namespace

TEST(TagTemplate, cornersComeBackFromTheHomography)
{
  for (const TagFamily& family : tagFamilies())
  {
    const Pattern pattern = patternOf(family.name, 1);
    EXPECT_EQ(pattern.widthAtBorder(), family.width_at_border);
    const Corners corners = tagCorners({320.0, 240.0}, 60.0, 0.4, 0.7, 1.0);
    EXPECT_LT(distance(patternCorners(toPattern(corners, pattern), pattern), corners), 1e-9) << family.name;
  }
}

TEST(TagTemplate, jacobianIsThatOfTheLevel)
{
  cv::RNG random(41);
  for (const std::string family : {"tag36h11", "tagCustom48h12", "tagCircle49h12"})
    for (const double blur : {0.25, 0.7, 1.5})
    {
      const Pattern pattern = patternOf(family, 11);
      const BlurredGrid cells(pattern.cells);
      const View view = viewOf(tagCorners({320.0, 240.0}, 50.0, 0.4, 0.3, 1.0), pattern, blur);
      const cv::Matx33d to_picture = view.H.inv();
      for (int i = 0; i < 60; ++i)
      {
        const cv::Point2d place = mapped(to_picture, {random.uniform(-0.55, 0.55), random.uniform(-0.55, 0.55)}).point;
        Unknowns jacobian, unused;
        levelAt(cells, pattern.cells.cols, view, place, jacobian);
        for (int k = 0; k < kUnknowns; ++k)
        {
          const double step = k < kBlur ? 1e-6 : 1e-4;
          Unknowns by;
          by[k] = step;
          const double after = levelAt(cells, pattern.cells.cols, movedView(view, by), place, unused);
          const double before = levelAt(cells, pattern.cells.cols, movedView(view, -1.0 * by), place, unused);
          const double change = (after - before) / (2.0 * step);
          EXPECT_NEAR(jacobian[k], change, 0.02 * std::abs(change) + (k < kBlur ? 5.0 : 0.5))
              << family << " " << blur << " " << k;
        }
      }
    }
}

TEST(TemplateFit, findsTheCornersOfItsOwnModel)
{
  cv::RNG random(42);
  for (const TagFamily& family : tagFamilies())
    for (const double blur : {0.2, 0.3, 0.7, 1.5})
    {
      const Pattern pattern = patternOf(family.name, 5);
      const Corners truth = tagCorners({320.0, 240.0}, 50.0, 0.4, 0.3, 1.0);
      const auto samples = samplesOf(pattern, viewOf(truth, pattern, blur), 0.5, random);
      Corners near = truth;
      for (cv::Point2d& corner : near)
        corner += cv::Point2d(random.gaussian(0.2), random.gaussian(0.2));
      const auto found = fitPattern(pattern, samples, near);
      ASSERT_TRUE(found) << family.name << " " << blur;
      EXPECT_LT(distance(found->corners, truth), 0.02) << family.name << " " << blur;
    }
}

TEST(TemplateFit, covarianceIsThatOfTheCorners)
{
  cv::RNG random(43);
  const Pattern pattern = patternOf("tag36h11", 5);
  const Corners truth = tagCorners({320.0, 240.0}, 50.0, 0.4, 0.3, 1.0);
  for (const auto& [blur, most] : std::map<double, double>{{0.3, 1.9}, {0.5, 1.4}, {1.0, 1.4}})
  {
    const int runs = 60;
    double squares = 0.0;
    for (int run = 0; run < runs; ++run)
    {
      const auto samples = samplesOf(pattern, viewOf(truth, pattern, blur), 4.0, random);
      const auto found = fitPattern(pattern, samples, truth);
      ASSERT_TRUE(found) << blur;
      cv::Vec<double, 8> off;
      for (int i = 0; i < 4; ++i)
      {
        const cv::Point2d d = found->corners[static_cast<std::size_t>(i)] - truth[static_cast<std::size_t>(i)];
        off[2 * i] = d.x;
        off[2 * i + 1] = d.y;
      }
      squares += off.dot(found->covariance.solve(off, cv::DECOMP_CHOLESKY)) / 8.0;
    }
    EXPECT_GT(squares / runs, 0.75) << blur;
    EXPECT_LT(squares / runs, most) << blur;  // few pixels tell of sharp edges
  }
}

TEST(TemplateFit, tooFewSamplesSayNothing)
{
  cv::RNG random(44);
  const Pattern pattern = patternOf("tag36h11", 5);
  const Corners truth = tagCorners({320.0, 240.0}, 50.0);
  auto samples = samplesOf(pattern, viewOf(truth, pattern, 0.7), 1.0, random);
  EXPECT_TRUE(fitPattern(pattern, samples, truth));
  samples.resize(40);
  EXPECT_FALSE(fitPattern(pattern, samples, truth));
  EXPECT_FALSE(fitPattern(pattern, {}, truth));
}
