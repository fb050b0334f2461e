#include "robot_vision/tags/pose/corner_refinement.hpp"

#include <gtest/gtest.h>

#include "support/found_tags.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

using Corners = std::array<cv::Point2d, 4>;

constexpr const char* kFamily = "tag36h11";
const cv::Size kSize(160, 120);
const CameraModel kCamera{160, 120, {150.0, 0.0, 80.0, 0.0, 150.0, 60.0, 0.0, 0.0, 1.0}, {}};

struct Shot
{
  std::string family = kFamily;
  double side = 50.0, blur = 0.7, noise = 2.0;
  int free_level = 0;  // gray level of the free cells
};

/// Draws a tag. Each pixel is the mean of 6x6 points.
cv::Mat imageOf(const Shot& shot, int id, const Corners& corners, cv::RNG& random)
{
  constexpr int kFine = 6;
  const TagFamily& facts = tagFamily(shot.family);
  const int border = (facts.width - facts.width_at_border) / 2 + 1;
  const cv::Mat paper = paperOf(shot.family, id);
  cv::Mat levels, fine(kSize * kFine, CV_32FC1, cv::Scalar(140.0));
  cv::Mat(paper == 255).convertTo(levels, CV_32F, 190.0 / 255.0, 30.0);
  levels.setTo(shot.free_level, paper == kFreeCell);
  drawCells(levels, pixelsToCells(corners, paper, border), {}, kFine, fine);
  cv::Mat image;
  if (shot.blur > 0.0) cv::GaussianBlur(fine, fine, {0, 0}, shot.blur * kFine);
  cv::resize(fine, image, kSize, 0, 0, cv::INTER_AREA);
  cv::Mat noise(kSize, CV_32FC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, shot.noise);
  image += noise;
  image.convertTo(image, CV_8U);
  return image;
}

Corners randomCorners(double side, cv::RNG& random)
{
  return tagCorners({80.0 + random.uniform(-4.0, 4.0), 60.0 + random.uniform(-4.0, 4.0)}, side,
                    random.uniform(0.0, 6.0), random.uniform(0.0, 0.7), random.uniform(0.0, 6.0));
}

std::optional<robot_vision::TagCorners> measure(const cv::Mat& image, const std::string& family, int id,
                                                const Corners& near, const CameraModel& camera = kCamera)
{
  return measureCorners(image, tagCells(family, id), tagFamily(family).width_at_border, {id, near}, camera);
}

/// The errors of many tags: the root mean square of the coordinates' errors (px), the mean of their squares divided by
/// the covariance (1 if the covariance is right), and the number of tags that were not found.
struct Errors
{
  double px = 0.0, squares = 0.0;
  int missed = 0;
};

Errors errorsOf(const Shot& shot, int runs, std::uint64_t seed, const cv::Mat& sharpen = {})
{
  cv::RNG random(seed);
  Errors errors;
  int seen = 0;
  for (int run = 0; run < runs; ++run)
  {
    const int id = random.uniform(0, tagFamily(shot.family).ids);
    const Corners truth = randomCorners(shot.side, random);
    cv::Mat image = imageOf(shot, id, truth, random);
    if (!sharpen.empty()) cv::filter2D(image, image, -1, sharpen);
    const auto found = measure(image, shot.family, id, shaken(truth, 0.15, random));
    if (!found && ++errors.missed) continue;
    ++seen;
    const cv::Vec<double, 8> off = cornerErrors(found->corners, truth);
    errors.px += off.dot(off) / 8.0;
    errors.squares += off.dot(found->covariance->solve(off, cv::DECOMP_CHOLESKY)) / 8.0;
  }
  errors.px = std::sqrt(errors.px / seen);
  errors.squares /= seen;
  return errors;
}

}  // namespace

TEST(RefinedCorners, areRightForEveryFamilyWhateverItsFreeCells)
{
  for (const TagFamily& family : tagFamilies())
    for (const int free_level : {0, 128, 255})
    {
      Shot shot;
      shot.family = family.name;
      shot.side = 36.0;
      shot.free_level = free_level;
      const Errors errors = errorsOf(shot, 6, 51);
      EXPECT_EQ(errors.missed, 0) << family.name << free_level;
      EXPECT_LT(errors.px, 0.02) << family.name << free_level;
      EXPECT_LT(errors.squares, 3.0) << family.name << free_level;
      const bool has_none = cv::countNonZero(tagCells(family.name, 0) == kFreeCell) == 0;
      if (has_none) break;
    }
}

TEST(RefinedCorners, areWithinHundredthsOfAPixel)
{
  const struct
  {
    double blur, noise, side, max_px;
  } cases[] = {{0.3, 1.0, 24.0, 0.02}, {0.3, 6.0, 24.0, 0.04}, {0.3, 2.0, 60.0, 0.02}, {0.7, 2.0, 16.0, 0.025},
               {0.7, 2.0, 60.0, 0.02}, {1.2, 2.0, 24.0, 0.03}, {1.2, 6.0, 60.0, 0.06}, {2.0, 2.0, 60.0, 0.04}};
  double squares = 0.0;
  for (const auto& one : cases)
  {
    Shot shot;
    shot.blur = one.blur;
    shot.noise = one.noise;
    shot.side = one.side;
    const Errors errors = errorsOf(shot, 12, 52);
    EXPECT_EQ(errors.missed, 0) << one.blur << " " << one.noise << " " << one.side;
    EXPECT_LT(errors.px, one.max_px) << one.blur << " " << one.noise << " " << one.side;
    EXPECT_GT(errors.squares, 0.5) << one.blur << " " << one.noise << " " << one.side;
    EXPECT_LT(errors.squares, 2.2) << one.blur << " " << one.noise << " " << one.side;
    squares += errors.squares / static_cast<double>(std::size(cases));
  }
  EXPECT_GT(squares, 0.7);
  EXPECT_LT(squares, 1.5);
}

TEST(RefinedCorners, areRightInImagesSharperThanFromAnyLens)
{
  const cv::Mat sharpen = (cv::Mat_<double>(3, 3) << 0.0, -0.3, 0.0, -0.3, 2.2, -0.3, 0.0, -0.3, 0.0);
  for (const double side : {16.0, 24.0, 50.0})
  {
    Shot shot;
    shot.side = side;
    shot.blur = 0.0;
    const Errors sharp = errorsOf(shot, 12, 53), sharpened = errorsOf(shot, 12, 53, sharpen);
    EXPECT_EQ(sharp.missed, 0) << side;
    EXPECT_LT(sharp.px, 0.03) << side;
    EXPECT_LT(sharp.squares, 2.2) << side;
    EXPECT_LE(sharpened.missed, 2) << side;  // a refusal is better than a wrong result
    EXPECT_LT(sharpened.px, 0.06) << side;
    EXPECT_LT(sharpened.squares, 2.8) << side;
  }
}

TEST(RefinedCorners, areRightForDrawnTagsWithEdgesBetweenPixels)
{
  const int cell = 7, border = 2, width = tagFamily(kFamily).width_at_border;
  const double near = 10.0 + border * cell - 0.5, far = near + width * cell;
  const Corners truth = {{{near, far}, {far, far}, {far, near}, {near, near}}};
  cv::RNG random(57);
  for (const double noise : {0.0, 2.0, 4.0})
    for (int id = 0; id < 40; ++id)
    {
      cv::Mat paper, image(kSize, CV_8UC1, cv::Scalar(255));
      cv::resize(paperOf(kFamily, id), paper, {}, cell, cell, cv::INTER_NEAREST);
      paper.copyTo(image({10, 10, paper.cols, paper.rows}));
      addNoise(image, noise, random);
      const auto found = measure(image, kFamily, id, shaken(truth, 0.15, random));
      ASSERT_TRUE(found) << "tag " << id << ", noise " << noise;
      const cv::Vec<double, 8> off = cornerErrors(found->corners, truth);
      EXPECT_LT(cv::norm(off, cv::NORM_INF), 0.1 + 0.02 * noise) << "tag " << id << ", noise " << noise;
      EXPECT_LT(off.dot(found->covariance->solve(off, cv::DECOMP_CHOLESKY)) / 8.0, 3.0)
          << "tag " << id << ", noise " << noise;
    }
}

TEST(RefinedCorners, areRightInOverexposedAndUnderexposedImages)
{
  cv::RNG random(54);
  for (const double offset : {60.0, -45.0})  // makes white 255, or black 0, including the noise
    for (int run = 0; run < 6; ++run)
    {
      const Corners truth = randomCorners(40.0, random);
      cv::Mat image = imageOf(Shot(), 3, truth, random);
      image.convertTo(image, CV_8U, 1.0, offset);
      const auto found = measure(image, kFamily, 3, truth);
      ASSERT_TRUE(found) << offset;
      EXPECT_LT(distance(found->corners, truth), 0.12) << offset;
    }
}

TEST(RefinedCorners, doNotDependOnThePaddingOfRows)
{
  cv::RNG random(55);
  const Corners truth = randomCorners(40.0, random);
  const cv::Mat image = imageOf(Shot(), 3, truth, random);
  cv::Mat padded = noise(kSize, CV_8UC1, 37);
  image.copyTo(padded);
  const cv::Mat before = padded.clone();
  const auto expected = measure(image, kFamily, 3, truth), found = measure(padded, kFamily, 3, truth);
  ASSERT_TRUE(expected && found);
  EXPECT_EQ(distance(expected->corners, found->corners), 0.0);
  EXPECT_EQ(cv::norm(*expected->covariance, *found->covariance), 0.0);
  EXPECT_TRUE(equal(padded, before));
}

TEST(RefinedCorners, areRightAtTheBorderOfTheImage)
{
  cv::RNG random(56);
  const Corners truth = tagCorners({80.0, 60.0}, 40.0, 0.1);
  const cv::Mat image = imageOf(Shot(), 3, truth, random);
  for (int cut = 34; cut < 80; cut += 3)  // from the whole tag to half of it
  {
    const cv::Mat part = image.colRange(cut, kSize.width);
    Corners moved = truth;
    for (cv::Point2d& corner : moved)
      corner.x -= cut;
    CameraModel camera = kCamera;
    camera.K(0, 2) -= cut;
    const auto found = measure(part, kFamily, 3, moved, camera);
    const bool is_all_there = cut < 56;
    ASSERT_TRUE(found || !is_all_there) << cut;
    if (!found) continue;
    const double deviation = std::sqrt(cv::trace(*found->covariance) / 8.0);
    EXPECT_LT(distance(found->corners, moved), std::max(0.08, 6.0 * deviation)) << cut;
  }
  for (cv::Point2d far : {cv::Point2d(30.0, 30.0), cv::Point2d(300.0, 0.0), cv::Point2d(0.0, -1e6)})
  {
    Corners moved = truth;
    for (cv::Point2d& corner : moved)
      corner += far;
    EXPECT_FALSE(measure(image, kFamily, 3, moved));
  }
}

TEST(RefinedCorners, areNotGivenIfTheImageDoesNotShowTheTag)
{
  cv::RNG random(57);
  const Corners truth = randomCorners(40.0, random);
  const cv::Mat image = imageOf(Shot(), 3, truth, random);
  ASSERT_TRUE(measure(image, kFamily, 3, truth));
  EXPECT_FALSE(measure(image, kFamily, 4, truth));
  EXPECT_FALSE(measure(cv::Mat(kSize, CV_8UC1, cv::Scalar(90)), kFamily, 3, truth));
  EXPECT_FALSE(measure(noise(kSize, CV_8UC1), kFamily, 3, truth));
  Corners nowhere = truth;
  nowhere[1].x = std::nan("");
  EXPECT_FALSE(measure(image, kFamily, 3, nowhere));
  nowhere.fill({80.0, 60.0});
  EXPECT_FALSE(measure(image, kFamily, 3, nowhere));
  cv::Mat covered = image.clone();
  covered.colRange(70, kSize.width) = 128;
  EXPECT_FALSE(measure(covered, kFamily, 3, truth));
}

TEST(RefinedCorners, haveCovariancesThatEstimatePoseAccepts)
{
  Shot shot;
  shot.family = "tagCircle21h7";
  shot.noise = 0.0;
  cv::RNG random(46);
  for (int run = 0; run < 120; ++run)
  {
    // In perfect images along the pixels, some unknowns hardly show.
    const int id = run % tagFamily(shot.family).ids;
    const double side = 20.0 + 0.5 * (run % 60);
    shot.blur = 0.1 * (run % 7);
    const Corners truth = tagCorners({80.0, 60.0}, side);
    const auto found = measure(imageOf(shot, id, truth, random), shot.family, id, truth);
    if (!found) continue;
    EXPECT_EQ(cv::norm(*found->covariance - found->covariance->t()), 0.0) << run;
    EXPECT_EQ(refusal([&] { estimatePose(singleTag(id, 0.1), {*found}, kCamera, 0.2, 0.1); }), "") << run;
  }
}

TEST(RefinedCorners, areRefusedForWrongInput)
{
  const Corners corners = tagCorners({80.0, 60.0}, 40.0);
  const cv::Mat gray = grayWall(kSize), cells = tagCells(kFamily, 3);
  const auto error = [&](const cv::Mat& image, const cv::Mat& pattern, int width, const CameraModel& camera) {
    return refusal([&] { measureCorners(image, pattern, width, {3, corners}, camera); });
  };
  const std::string expected = ", must be not empty, 1 x 8 bits (CV_8UC1)";
  EXPECT_EQ(error({}, cells, 8, kCamera), "gray is empty" + expected);
  EXPECT_EQ(error(cv::Mat(kSize, CV_8UC3), cells, 8, kCamera), "gray is 3 x 8 bits (CV_8UC3)" + expected);
  EXPECT_EQ(error(cv::Mat(kSize, CV_16UC1), cells, 8, kCamera), "gray is 1 x 16 bits (CV_16UC1)" + expected);
  EXPECT_EQ(error(gray, {}, 8, kCamera), "cells is empty" + expected);
  EXPECT_EQ(error(gray, cv::Mat(10, 10, CV_32FC1), 8, kCamera), "cells is 1 x 32 bits (CV_32FC1)" + expected);
  EXPECT_EQ(error(gray, cells.rowRange(0, 9), 8, kCamera),
            "cells is 10x9, must be those of a tag that is 8 wide at its border");
  for (const int width : {-8, 0, 7, 9, 10, 12})
    EXPECT_EQ(error(gray, cells, width, kCamera),
              "cells is 10x10, must be those of a tag that is " + std::to_string(width) + " wide at its border");
  CameraModel camera = kCamera;
  camera.K(0, 0) = 0.0;
  EXPECT_NE(error(gray, cells, 8, camera), "");
  EXPECT_EQ(error(gray, cells, 8, kCamera), "");
}
