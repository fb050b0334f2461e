#include "core/tags/pose/template_fit.hpp"

#include <gtest/gtest.h>

#include <map>

#include "support/found_tags.hpp"

using namespace robot_vision;

namespace
{

using Corners = std::array<cv::Point2d, 4>;

TagTemplate templateOf(const std::string& family, int id)
{
  const TagFamily& facts = tagFamily(family);
  return {tagCells(family, id), (facts.width - facts.width_at_border) / 2};
}

TagView viewOf(const Corners& corners, const TagTemplate& tag_template, double blur)
{
  TagView view{toTemplate(corners, tag_template), {}};
  view.appearance[kBlur] = blur;
  view.appearance[kBlack] = 30.0;
  view.appearance[kBlack + 1] = 6.0;
  view.appearance[kBlack + 2] = -9.0;
  view.appearance[kContrast] = 170.0;
  view.appearance[kContrast + 1] = 12.0;
  view.appearance[kContrast + 2] = 5.0;
  view.appearance[kAround] = 90.0;
  return view;
}

/// Samples near the edges of a tag, with the gray levels of the view and some noise.
std::vector<GraySample> samplesOf(const TagTemplate& tag_template, const TagView& view, double noise, cv::RNG& random)
{
  const BlurredGrid cells(tag_template.cells);
  const cv::Matx33d to_image = view.H.inv();
  std::vector<GraySample> samples;
  while (samples.size() < 320)
  {
    const cv::Point2d q(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5));
    const cv::Point2d position = mapped(to_image, q).point;
    Unknowns jacobian;
    const double gray = grayAt(cells, tag_template.cells.cols, view, position, jacobian);
    const bool is_near_edge = std::abs(jacobian[0]) + std::abs(jacobian[3]) > 20.0;
    if (is_near_edge) samples.push_back({position, gray + random.gaussian(noise)});
  }
  return samples;
}

}  // namespace

TEST(TagTemplate, cornersComeBackFromTheHomography)
{
  for (const TagFamily& family : tagFamilies())
  {
    const TagTemplate tag_template = templateOf(family.name, 1);
    EXPECT_EQ(tag_template.widthAtBorder(), family.width_at_border);
    const Corners corners = tagCorners({320.0, 240.0}, 60.0, 0.4, 0.7, 1.0);
    EXPECT_LT(distance(templateCorners(toTemplate(corners, tag_template), tag_template), corners), 1e-9) << family.name;
  }
}

TEST(TagTemplate, jacobianIsThatOfTheLevel)
{
  cv::RNG random(41);
  for (const std::string family : {"tag36h11", "tagCustom48h12", "tagCircle49h12"})
    for (const double blur : {0.25, 0.7, 1.5})
    {
      const TagTemplate tag_template = templateOf(family, 11);
      const BlurredGrid cells(tag_template.cells);
      const TagView view = viewOf(tagCorners({320.0, 240.0}, 50.0, 0.4, 0.3, 1.0), tag_template, blur);
      const cv::Matx33d to_image = view.H.inv();
      for (int i = 0; i < 60; ++i)
      {
        const cv::Point2d position = mapped(to_image, {random.uniform(-0.55, 0.55), random.uniform(-0.55, 0.55)}).point;
        Unknowns jacobian, unused;
        grayAt(cells, tag_template.cells.cols, view, position, jacobian);
        for (int k = 0; k < kUnknowns; ++k)
        {
          const double step = k < kBlur ? 1e-6 : 1e-4;
          Unknowns by;
          by[k] = step;
          const double after = grayAt(cells, tag_template.cells.cols, movedView(view, by), position, unused);
          const double before = grayAt(cells, tag_template.cells.cols, movedView(view, -1.0 * by), position, unused);
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
      const TagTemplate tag_template = templateOf(family.name, 5);
      const Corners truth = tagCorners({320.0, 240.0}, 50.0, 0.4, 0.3, 1.0);
      const auto samples = samplesOf(tag_template, viewOf(truth, tag_template, blur), 0.5, random);
      const auto found = fitTemplate(tag_template, samples, shaken(truth, 0.2, random));
      ASSERT_TRUE(found) << family.name << " " << blur;
      EXPECT_LT(distance(found->corners, truth), 0.02) << family.name << " " << blur;
    }
}

TEST(TemplateFit, covarianceIsThatOfTheErrors)
{
  cv::RNG random(43);
  const TagTemplate tag_template = templateOf("tag36h11", 5);
  const Corners truth = tagCorners({320.0, 240.0}, 50.0, 0.4, 0.3, 1.0);
  for (const auto& [blur, max_error] : std::map<double, double>{{0.3, 1.9}, {0.5, 1.4}, {1.0, 1.4}})
  {
    const int runs = 60;
    double squares = 0.0;
    for (int run = 0; run < runs; ++run)
    {
      const auto samples = samplesOf(tag_template, viewOf(truth, tag_template, blur), 4.0, random);
      const auto found = fitTemplate(tag_template, samples, truth);
      ASSERT_TRUE(found) << blur;
      const cv::Vec<double, 8> off = cornerErrors(found->corners, truth);
      squares += off.dot(found->covariance.solve(off, cv::DECOMP_CHOLESKY)) / 8.0;
    }
    EXPECT_GT(squares / runs, 0.75) << blur;
    EXPECT_LT(squares / runs, max_error) << blur;  // few pixels show sharp edges
  }
}

TEST(TemplateFit, tooFewSamplesGiveNoResult)
{
  cv::RNG random(44);
  const TagTemplate tag_template = templateOf("tag36h11", 5);
  const Corners truth = tagCorners({320.0, 240.0}, 50.0);
  auto samples = samplesOf(tag_template, viewOf(truth, tag_template, 0.7), 1.0, random);
  EXPECT_TRUE(fitTemplate(tag_template, samples, truth));
  samples.resize(40);
  EXPECT_FALSE(fitTemplate(tag_template, samples, truth));
  EXPECT_FALSE(fitTemplate(tag_template, {}, truth));
}
