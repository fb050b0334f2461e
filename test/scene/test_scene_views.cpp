#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "robot_vision/scene/scene.hpp"
#include "support/refusal.hpp"
#include "support/scenes.hpp"

using namespace robot_vision;

namespace
{

cv::Point3d onRay(const CameraModel& camera, const cv::Point2d& pixel, double z)
{
  const cv::Point2d ray = camera.ray(pixel);
  return {z * ray.x, z * ray.y, z};
}

/// Pixels along the border of an image.
std::vector<cv::Point2d> border(const CameraModel& camera)
{
  std::vector<cv::Point2d> pixels;
  const double right = camera.width - 1, bottom = camera.height - 1;
  for (double part = 0.0; part <= 1.0; part += 0.05)
    for (const double side : {0.0, 1.0})
    {
      pixels.emplace_back(part * right, side * bottom);
      pixels.emplace_back(side * right, part * bottom);
    }
  return pixels;
}

}  // namespace

TEST(SceneView, hasAName)
{
  EXPECT_EQ(sceneView("color"), SceneView::kColor);
  EXPECT_EQ(sceneView("right"), SceneView::kRight);
  EXPECT_EQ(sceneView("depth"), SceneView::kDepth);
  EXPECT_EQ(refusal([] { sceneView("top"); }), "view is 'top', must be color, right or depth");
}

TEST(SceneView, ofTheRightIsTheColorCameraMovedToTheRight)
{
  const CameraModel &left = sharedScene().camera(), &right = sharedScene().camera(SceneView::kRight);
  EXPECT_EQ(right.K, left.K);
  EXPECT_EQ(right.D, left.D);
  EXPECT_EQ(cv::Size(right.width, right.height), cv::Size(left.width, left.height));
  const cv::Affine3d pose = sharedScene().viewPose(SceneView::kRight);
  EXPECT_EQ(pose.rotation(), cv::Matx33d::eye());
  EXPECT_EQ(pose.translation(), cv::Vec3d(0.1, 0.0, 0.0));
  EXPECT_EQ(sharedScene().viewPose(SceneView::kColor).matrix, cv::Matx44d::eye());
}

TEST(SceneView, ofDepthIsAlwaysFourToThreeAndAtMostVga)
{
  const struct
  {
    cv::Size color, depth;
  } sizes[] = {{{640, 480}, {640, 480}}, {{1920, 1080}, {640, 480}}, {{320, 240}, {320, 240}},
               {{64, 64}, {64, 48}},     {{101, 101}, {100, 75}},    {{384, 128}, {384, 288}}};
  for (const auto& size : sizes)
  {
    const CalibrationScene scene(withoutNoise(size.color.width, size.color.height));
    const CameraModel& camera = scene.camera(SceneView::kDepth);
    EXPECT_EQ(cv::Size(camera.width, camera.height), size.depth) << size.color;
    EXPECT_NO_THROW(validate(camera));
    for (const cv::Point2d& pixel : border(camera))
      EXPECT_LT(cv::norm(camera.project(onRay(camera, pixel, 2.0)) - pixel), 1e-6);
    EXPECT_EQ(renderedDepth(scene, 0).size(), size.depth);
  }
}

TEST(SceneView, ofDepthIsToTheLeftAndSeesWhatTheColorCameraSees)
{
  const cv::Affine3d pose = sharedScene().viewPose(SceneView::kDepth);
  EXPECT_EQ(pose.rotation(), cv::Matx33d::eye());
  EXPECT_EQ(pose.translation(), cv::Vec3d(-0.025, 0.0, 0.0));
  const CameraModel &color = sharedScene().camera(), &depth = sharedScene().camera(SceneView::kDepth);
  const cv::Rect2d image(-0.5, -0.5, depth.width, depth.height);
  for (const cv::Point2d& pixel : border(color))
    for (const double z : {0.6, 5.0})
      EXPECT_TRUE(image.contains(depth.project(pose.inv() * onRay(color, pixel, z)))) << pixel << " at " << z;
}

TEST(SceneView, ofDepthHasNoColors)
{
  cv::Mat image;
  EXPECT_EQ(refusal([&] { sharedScene().render(0, image, SceneView::kDepth); }),
            "view is 'depth', must be color or right for an image in color");
  EXPECT_TRUE(image.empty());
}

TEST(SceneView, ofTheRightHasTheCheckerboardWhereTheTruthIs)
{
  double worst = 0.0;
  for (const int frame : {0, 210, 450})
  {
    const cv::Affine3d board =
        sharedScene().viewPose(SceneView::kRight).inv() * find(sharedScene().truth(frame), "checkerboard").pose;
    std::vector<cv::Point2f> expected;
    for (int i = 0; i < 8 * 6; ++i)
    {
      const cv::Point3d corner((i % 8 - 3.5) * kSceneCheckerSquare, (i / 8 - 2.5) * kSceneCheckerSquare, 0.0);
      expected.emplace_back(sharedScene().camera(SceneView::kRight).project(board * corner));
    }
    std::vector<cv::Point2f> found = expected;
    for (cv::Point2f& corner : found)
      corner += cv::Point2f(0.6F, -0.5F);
    const cv::TermCriteria stop(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 50, 1e-4);
    cv::cornerSubPix(renderedGray(sharedScene(), frame, SceneView::kRight), found, {4, 4}, {-1, -1}, stop);
    for (std::size_t i = 0; i < found.size(); ++i)
      worst = std::max(worst, cv::norm(found[i] - expected[i]));
  }
  EXPECT_LT(worst, 0.1);
}

TEST(SceneView, ofTheRightShowsWhatTheLeftShowsAtTheDisparityOfTheDepth)
{
  const int frame = 150, every = 3;
  const CameraModel& camera = sharedScene().camera();
  const cv::Mat left = renderedGray(sharedScene(), frame),
                right = renderedGray(sharedScene(), frame, SceneView::kRight);
  const cv::Mat left_depth = renderedDepth(sharedScene(), frame, SceneView::kColor);
  const cv::Mat right_depth = renderedDepth(sharedScene(), frame, SceneView::kRight);
  const cv::Rect2d inside(1, 1, camera.width - 3, camera.height - 3);
  double compared = 0.0, difference = 0.0, beside = 0.0;
  for (int y = 0; y < right.rows; y += every)
    for (int x = 0; x < right.cols; x += every)
    {
      const double z = right_depth.at<float>(y, x);
      const cv::Point3d point = onRay(camera, cv::Point2d(x, y), z) + cv::Point3d(kSceneStereoBaseline, 0.0, 0.0);
      const cv::Point2d seen = camera.project(point), moved = seen + cv::Point2d(4.0, 0.0);
      if (!inside.contains(seen) || !inside.contains(moved)) continue;
      if (std::abs(left_depth.at<float>(cv::Point(seen)) - z) > 0.01 * z) continue;  // the left one sees something else
      compared += 1.0;
      difference += std::abs(grayAt(left, seen) - right.at<uchar>(y, x));
      beside += std::abs(grayAt(left, moved) - right.at<uchar>(y, x));
    }
  EXPECT_GT(compared * every * every, 0.6 * right.total());
  EXPECT_LT(difference / compared, 2.0);  // gray levels
  EXPECT_GT(beside, 2.0 * difference);
}

TEST(SceneView, ofTheRightHasNoiseOfItsOwn)
{
  SceneParams params = withoutNoise(320, 240);
  const Scene clean(params);
  params.noise = 4.0;
  const Scene noisy(params);
  std::vector<cv::Mat> noise;
  for (const SceneView view : {SceneView::kColor, SceneView::kRight})
  {
    cv::subtract(rendered(noisy, 9, view), rendered(clean, 9, view), noise.emplace_back(), cv::noArray(), CV_32F);
    cv::Scalar mean, deviation;
    cv::meanStdDev(noise.back().reshape(1), mean, deviation);
    EXPECT_NEAR(mean[0], 0.0, 0.1);
    EXPECT_NEAR(deviation[0], 4.0, 0.15);
  }
  const double correlation = noise[0].dot(noise[1]) / (cv::norm(noise[0]) * cv::norm(noise[1]));
  EXPECT_LT(std::abs(correlation), 0.02);
}
