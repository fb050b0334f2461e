#include "robot_vision/scene/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "support/images.hpp"
#include "support/refusal.hpp"
#include "support/scenes.hpp"

using namespace robot_vision;

TEST(SceneParams, acceptsItsLimits)
{
  for (const int size : {64, 4096})
    EXPECT_NO_THROW(validate(SceneParams{size, size, 1000.0, 1, 30.0}));
}

TEST(SceneParams, limitsTheProportionsOfTheImage)
{
  EXPECT_EQ(refusalWith(&SceneParams::width, 1500), "width is 1500, must be at most 3 times the height");
  EXPECT_EQ(refusalWith(&SceneParams::height, 1930), "height is 1930, must be at most 3 times the width");
  EXPECT_EQ(refusal([] { Scene(SceneParams{640, 5000}); }), "height is 5000, must be from 64 to 4096");
}

TEST(Scene, refusesAPosterOfAnotherType)
{
  EXPECT_THROW(Scene(SceneParams{}, cv::Mat(8, 8, CV_8UC1, cv::Scalar(0))), std::invalid_argument);
}

TEST(RayTable, hasTheRaysOfTheCamera)
{
  const CameraModel& camera = sharedScene().camera();
  const RayTable table = rayTable(camera);
  for (const cv::Point pixel : {cv::Point(0, 0), cv::Point(639, 479), cv::Point(320, 240), cv::Point(17, 400)})
  {
    const cv::Point2d ray = camera.ray(pixel);
    EXPECT_LT(cv::norm(camera.project({2.0 * ray.x, 2.0 * ray.y, 2.0}) - cv::Point2d(pixel)), 1e-9);
    EXPECT_NEAR(table.x.at<float>(pixel), ray.x, 1e-6);
    EXPECT_NEAR(table.y.at<float>(pixel), ray.y, 1e-6);
  }
}

TEST(Scene, drawsTheSameFrameInAnyOrderInstanceAndThread)
{
  SceneParams params = withoutNoise(320, 240);
  params.noise = 2.0;
  const Scene one(params), other(params);
  const cv::Mat first = rendered(one, 7), later = rendered(one, 250);
  EXPECT_FALSE(equal(first, later));
  EXPECT_TRUE(equal(rendered(other, 250), later));
  EXPECT_TRUE(equal(rendered(other, 7), first));
  cv::Mat a, b;
  std::thread thread([&] { one.render(7, a); });
  one.render(250, b);
  thread.join();
  EXPECT_TRUE(equal(a, first));
  EXPECT_TRUE(equal(b, later));
}

TEST(Scene, repeatsItsMotionButNotItsNoise)
{
  SceneParams params = withoutNoise(320, 240);
  const std::int64_t period = std::llround(kScenePeriod * params.rate);
  const Scene still(params);
  const int away = 330;  // a frame in which the box is not where it starts
  EXPECT_LE(cv::norm(rendered(still, away), rendered(still, away + 1000 * period), cv::NORM_INF), 1.0);
  EXPECT_LE(cv::norm(rendered(still, away), rendered(still, away - period), cv::NORM_INF), 1.0);
  params.noise = 2.0;
  const Scene noisy(params);
  EXPECT_FALSE(equal(rendered(noisy, 5), rendered(noisy, 5 + period)));
}

TEST(Scene, seedChangesTheNoiseOnly)
{
  SceneParams params = withoutNoise(320, 240);
  const cv::Mat clean = rendered(Scene(params), 40);
  params.noise = 2.0;
  const cv::Mat one = rendered(Scene(params), 40);
  params.seed = 2;
  const cv::Mat two = rendered(Scene(params), 40);
  EXPECT_FALSE(equal(one, two));
  for (const cv::Mat& noisy : {one, two})
  {
    cv::Mat difference;
    cv::subtract(noisy, clean, difference, cv::noArray(), CV_16S);
    cv::Scalar mean, deviation;
    cv::meanStdDev(difference.reshape(1), mean, deviation);
    EXPECT_NEAR(mean[0], 0.0, 0.03);
    EXPECT_NEAR(deviation[0], 2.0, 0.06);
  }
}

TEST(Scene, writesIntoForeignPaddedRowsAndNothingElse)
{
  const int width = 320, height = 240, step = 3 * width + 13;
  const Scene scene(withoutNoise(width, height));
  std::vector<uchar> memory(static_cast<std::size_t>(step) * height, 0xa5);
  cv::Mat image(height, width, CV_8UC3, memory.data(), step);
  scene.render(3, image);
  EXPECT_EQ(image.data, memory.data());
  EXPECT_TRUE(equal(image, rendered(scene, 3)));
  for (int row = 0; row < height; ++row)
  {
    for (int i = 3 * width; i < step; ++i)
      ASSERT_EQ(memory[static_cast<std::size_t>(row) * step + i], 0xa5) << row;
  }
}

TEST(Scene, writesEveryPixelInEveryFormat)
{
  for (const cv::Size size : {cv::Size(320, 240), cv::Size(384, 128), cv::Size(128, 384), cv::Size(64, 64)})
  {
    const Scene scene(withoutNoise(size.width, size.height));
    cv::Mat over_black(size, CV_8UC3, cv::Scalar::all(0)), over_white(size, CV_8UC3, cv::Scalar::all(255));
    for (const int frame : {0, 150, 330, 480})
    {
      scene.render(frame, over_black);
      scene.render(frame, over_white);
      EXPECT_TRUE(equal(over_black, over_white)) << size << " frame " << frame;
    }
  }
}

TEST(SceneTruth, checkerboardCornersAreWhereTheImageShowsThem)
{
  double worst = 0.0, sum = 0.0;
  int count = 0;
  for (const int frame : {0, 90, 210, 330, 450})
  {
    const SceneTruth truth = sharedScene().truth(frame);
    const SceneObject board = find(truth, "checkerboard");
    ASSERT_TRUE(board.visible) << frame;
    std::vector<cv::Point2f> expected;
    for (int i = 0; i < 8 * 6; ++i)
    {
      const cv::Point3d corner((i % 8 - 3.5) * kSceneCheckerSquare, (i / 8 - 2.5) * kSceneCheckerSquare, 0.0);
      expected.emplace_back(sharedScene().camera().project(board.pose * corner));
    }
    EXPECT_LT(cv::norm(cv::Point2d(expected.front()) - board.outline[0]), 1e-3);
    EXPECT_LT(cv::norm(cv::Point2d(expected.back()) - board.outline[2]), 1e-3);
    std::vector<cv::Point2f> found = expected;
    for (cv::Point2f& corner : found)
      corner += cv::Point2f(0.6F, -0.5F);
    const cv::TermCriteria stop(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 50, 1e-4);
    cv::cornerSubPix(renderedGray(sharedScene(), frame), found, {4, 4}, {-1, -1}, stop);
    for (std::size_t i = 0; i < found.size(); ++i)
    {
      const double error = cv::norm(found[i] - expected[i]);
      worst = std::max(worst, error);
      sum += error;
      ++count;
    }
  }
  RecordProperty("worst_px", std::to_string(worst));
  EXPECT_LT(worst, 0.1);
  EXPECT_LT(sum / count, 0.03);
}

TEST(SceneTruth, ballCoversItsOutline)
{
  for (const int frame : {20, 60, 130, 260, 370})
  {
    const SceneTruth truth = sharedScene().truth(frame);
    const SceneObject ball = find(truth, "ball");
    ASSERT_TRUE(ball.visible) << frame;
    cv::Mat hsv, mask;
    cv::cvtColor(rendered(sharedScene(), frame), hsv, cv::COLOR_BGR2HSV);
    cv::inRange(hsv, cv::Scalar(90, 50, 50), cv::Scalar(120, 255, 255), mask);
    const cv::Moments moments = cv::moments(mask, true);
    const cv::Moments exact = cv::moments(std::vector<cv::Point2f>(ball.outline.begin(), ball.outline.end()));
    const cv::Point2d centroid(exact.m10 / exact.m00, exact.m01 / exact.m00);
    EXPECT_NEAR(moments.m10 / moments.m00, centroid.x, 0.25) << frame;
    EXPECT_NEAR(moments.m01 / moments.m00, centroid.y, 0.25) << frame;
    // Pixels on the edge are mixed with the background, so the mask may have them or not.
    EXPECT_NEAR(std::sqrt(moments.m00 / exact.m00), 1.0, 0.02) << frame;
    const double off_axis = cv::norm(centroid - ball.center);
    EXPECT_GT(off_axis, 0.001);
    EXPECT_LT(off_axis, 2.0);
  }
}

TEST(SceneTruth, tagEdgesAreWhereTheImageShowsThem)
{
  const double black = 28.0, white = 236.0;
  for (const char* name : {"tag_0", "tag_1"})
  {
    for (const int frame : {0, 60, 120, 330})
    {
      const SceneObject tag = find(sharedScene().truth(frame), name);
      ASSERT_TRUE(tag.visible) << name << frame;
      const cv::Mat image = renderedGray(sharedScene(), frame);
      const double half = kSceneTagSide / 2.0;
      for (int side = 0; side < 4; ++side)
      {
        // The integral of the mean profile across an edge tells where the step from black to white is.
        double offset = 0.0;
        const int samples = 40, steps = 40;
        for (int i = 0; i < samples; ++i)
        {
          const double along = (i / (samples - 1.0) - 0.5) * 1.4 * half, reach = 0.2 * half;
          double light = 0.0;
          for (int k = 0; k < steps; ++k)
          {
            const double across = half + ((k + 0.5) / steps * 2.0 - 1.0) * reach;
            cv::Point3d p(across, along, 0.0);
            for (int turn = 0; turn < side; ++turn)
              p = {-p.y, p.x, 0.0};
            light += grayAt(image, sharedScene().camera().project(tag.pose * p));
          }
          offset += (0.5 - (light / steps - black) / (white - black)) * 2.0 * reach / samples;
        }
        const double pixels_per_metre = cv::norm(tag.outline[1] - tag.outline[0]) / kSceneTagSide;
        EXPECT_LT(std::abs(offset * pixels_per_metre), 0.1) << name << " frame " << frame << " side " << side;
      }
    }
  }
}

TEST(SceneTruth, tagsCarryTheirCodewords)
{
  const std::uint64_t codes[] = {0xd5d628584, 0xd97f18b49};
  for (int id = 0; id < 2; ++id)
  {
    const SceneObject tag = find(sharedScene().truth(0), "tag_" + std::to_string(id));
    const cv::Mat image = renderedGray(sharedScene(), 0);
    EXPECT_GT(cv::norm(tag.outline[1] - tag.outline[0]), 40.0);
    std::uint64_t code = 0;
    for (int bit = 0; bit < 36; ++bit)
    {
      const double cell = kSceneTagSide / 8.0;
      const cv::Point3d p((bit % 6 - 2.5) * cell, (2.5 - bit / 6) * cell, 0.0);
      code = code << 1 | (grayAt(image, sharedScene().camera().project(tag.pose * p)) > 128.0 ? 1 : 0);
    }
    EXPECT_EQ(code, codes[id]);
  }
}

TEST(SceneTruth, cornersStartAtTheBottomLeftAndRunCounterClockwise)
{
  for (const char* name : {"tag_0", "tag_1", "qr_code", "checkerboard", "poster"})
  {
    const SceneObject board = find(sharedScene().truth(0), name);
    ASSERT_EQ(board.outline.size(), 4U) << name;
    EXPECT_LT(board.outline[0].x, board.outline[1].x) << name;
    EXPECT_GT(board.outline[1].y, board.outline[2].y) << name;
    EXPECT_GT(board.outline[2].x, board.outline[3].x) << name;
    EXPECT_LT(board.outline[3].y, board.outline[0].y) << name;
  }
}

TEST(SceneTruth, lineCrossesTheLowestQuarterDarkOnLight)
{
  for (int frame = 0; frame < 600; frame += 100)
  {
    const SceneObject line = find(sharedScene().truth(frame), "line");
    const cv::Mat image = renderedGray(sharedScene(), frame);
    for (const int row : {365, 420, 475})
    {
      // Where the outline crosses a row, the image must be dark between the crossings and half dark at them.
      std::vector<double> crossings;
      for (std::size_t i = 0; i < line.outline.size(); ++i)
      {
        const cv::Point2d &a = line.outline[i], &b = line.outline[(i + 1) % line.outline.size()];
        if ((a.y > row) != (b.y > row)) crossings.push_back(a.x + (b.x - a.x) * (row - a.y) / (b.y - a.y));
      }
      ASSERT_EQ(crossings.size(), 2U) << frame << " row " << row;
      const double width = std::abs(crossings[1] - crossings[0]), middle = (crossings[0] + crossings[1]) / 2.0;
      EXPECT_GT(width, 8.0);
      if (!line.visible) continue;  // the ball is in the way
      EXPECT_LT(grayAt(image, {middle, 1.0 * row}), 60.0);
      for (const double side : {-0.5, 0.5})
        EXPECT_NEAR(grayAt(image, {middle + side * width, 1.0 * row}), 108.0, 25.0) << frame << " row " << row;
    }
  }
}

TEST(SceneTruth, boxMovesNowAndThenOnly)
{
  int moving = 0;
  const int frames = 600;
  cv::Affine3d last;
  for (int frame = 0; frame < frames; ++frame)
  {
    const SceneTruth truth = sharedScene().truth(frame);
    const cv::Affine3d box = truth.camera * find(truth, "box").pose;
    if (frame > 0 && cv::norm(box.translation() - last.translation()) > 1e-6) ++moving;
    last = box;
  }
  EXPECT_GT(moving, frames / 10);
  EXPECT_LT(moving, frames / 3);
}

TEST(SceneTruth, aStillCameraStaysWhereItIsInTheFirstFrame)
{
  SceneParams params = withoutNoise();
  params.still = true;
  const Scene scene(params);
  for (const int frame : {0, 100, 250})
  {
    const SceneTruth truth = scene.truth(frame), moving = sharedScene().truth(frame);
    EXPECT_EQ(truth.camera.matrix, sharedScene().truth(0).camera.matrix);
    const auto inWorld = [](const SceneTruth& of) { return of.camera * find(of, "ball").pose; };
    EXPECT_LT(cv::norm(inWorld(truth).translation() - inWorld(moving).translation()), 1e-9);
  }
  cv::Mat still, moving;
  scene.render(0, still);
  sharedScene().render(0, moving);
  EXPECT_TRUE(equal(still, moving));
  scene.render(100, still);
  sharedScene().render(100, moving);
  EXPECT_FALSE(equal(still, moving));
}

TEST(SceneTruth, everythingIsVisibleMostOfTheTime)
{
  const std::vector<std::string> names = {"ball", "tag_0", "tag_1", "qr_code", "checkerboard", "line", "box", "poster"};
  std::vector<int> visible(names.size(), 0);
  const int frames = 600;
  for (int frame = 0; frame < frames; ++frame)
  {
    const SceneTruth truth = sharedScene().truth(frame);
    ASSERT_EQ(truth.frame, frame);
    ASSERT_EQ(truth.objects.size(), names.size());
    for (std::size_t i = 0; i < names.size(); ++i)
    {
      ASSERT_EQ(truth.objects[i].name, names[i]);
      visible[i] += truth.objects[i].visible;
      const cv::Point3d origin(truth.objects[i].pose.translation());
      ASSERT_LT(cv::norm(truth.objects[i].center - sharedScene().camera().project(origin)), 1e-9);
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    RecordProperty(names[i] + "_visible", visible[i]);
    EXPECT_GT(visible[i], frames / 2) << names[i];
  }
  EXPECT_LT(*std::min_element(visible.begin(), visible.end()), frames);  // something is covered now and then
}

TEST(SceneTruth, visibleObjectsAreNotBehindTheBall)
{
  int covered = 0;
  for (int frame = 0; frame < 600; frame += 3)
  {
    const SceneTruth truth = sharedScene().truth(frame);
    const SceneObject ball = find(truth, "ball");
    std::vector<cv::Point2f> outline(ball.outline.begin(), ball.outline.end());
    for (const SceneObject& other : truth.objects)
    {
      if (other.name == "ball") continue;
      const bool hides =
          std::any_of(other.outline.begin(), other.outline.end(),
                      [&](const cv::Point2d& p) { return cv::pointPolygonTest(outline, cv::Point2f(p), false) > 0; });
      covered += hides;
      EXPECT_FALSE(hides && other.visible) << other.name << " in frame " << frame;
    }
  }
  EXPECT_GT(covered, 0);
}

TEST(Scene, hangsThePosterItIsGiven)
{
  cv::Mat poster(200, 300, CV_8UC3, cv::Scalar(40, 200, 60));
  poster.colRange(150, 300).setTo(cv::Scalar(60, 40, 200));
  const cv::Mat before = poster.clone();
  const Scene scene(withoutNoise(), poster);
  const SceneObject object = find(scene.truth(0), "poster");
  const cv::Mat image = rendered(scene, 0);
  const double width = 1.1, height = width * 200 / 300;
  for (const double side : {-1.0, 1.0})
  {
    const cv::Point2d inside = scene.camera().project(object.pose * cv::Point3d(side * 0.45 * width, 0.4 * height, 0));
    const cv::Vec3b colour = image.at<cv::Vec3b>(cv::Point(inside));
    EXPECT_EQ(colour, (side < 0 ? cv::Vec3b(40, 200, 60) : cv::Vec3b(60, 40, 200)));
  }
  EXPECT_GT(cv::norm(object.outline[1] - object.outline[0]), 200.0);
  EXPECT_TRUE(equal(poster, before));
}
