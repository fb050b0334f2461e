#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <thread>
#include <vector>

#include "robot_vision/scene/scene.hpp"
#include "support/scenes.hpp"

using namespace robot_vision;

namespace
{

const double kNothing = std::numeric_limits<double>::infinity();
const double kTolerance = 5e-6;  // m; that of a float at 3 m is 3e-7
const SceneView kViews[] = {SceneView::kColor, SceneView::kRight, SceneView::kDepth};

/// A rectangle around the origin of its pose, whose plane is z = 0.
struct Rectangle
{
  cv::Affine3d pose;
  cv::Size2d size;
};

struct Ball
{
  cv::Vec3d center;
};

/// z of the first point that a ray (x, y, 1) meets, kNothing if it meets none.
double metAt(const Rectangle& thing, const cv::Vec3d& ray)
{
  const cv::Vec3d origin = thing.pose.translation(), normal = thing.pose.rotation() * cv::Vec3d(0, 0, 1);
  const double z = normal.dot(origin) / normal.dot(ray);
  const cv::Vec3d place = thing.pose.rotation().t() * (z * ray - origin);
  const bool inside = std::abs(place[0]) <= thing.size.width / 2 && std::abs(place[1]) <= thing.size.height / 2;
  return z > 0.0 && inside ? z : kNothing;
}

double metAt(const Ball& thing, const cv::Vec3d& ray)
{
  const double square = ray.dot(ray), nearest = thing.center.dot(ray) / square;  // z of the nearest point to the middle
  const cv::Vec3d beside = nearest * ray - thing.center;
  const double within = kSceneBallRadius * kSceneBallRadius - beside.dot(beside);
  return within < 0.0 ? kNothing : nearest - std::sqrt(within / square);
}

/// What the truth knows of a frame of the room: floor, boards, box and ball, in a view's optical frame. The walls are
/// behind all of it.
struct KnownRoom
{
  KnownRoom(const Scene& scene, std::int64_t frame, SceneView view)
  {
    const SceneTruth truth = scene.truth(frame);
    const cv::Affine3d to_view = scene.viewPose(view).inv();
    const auto add = [&](const cv::Affine3d& pose, double width, double height) {
      rectangles.push_back({to_view * pose, {width, height}});
    };
    // The part of the floor that is not below skirtings: 3.6 m forward and 3.4 m to the left.
    add(truth.camera.inv() * cv::Affine3d(cv::Matx33d::eye(), {0.8, 0.0, 0.0}), 3.6, 3.4);
    const double tag = kSceneTagSide * 10 / 8, qr = kSceneQrSide * 27 / 21;  // with their margins
    add(find(truth, "tag_0").pose, tag, tag);
    add(find(truth, "tag_1").pose, tag, tag);
    add(find(truth, "qr_code").pose, qr, qr);
    add(find(truth, "checkerboard").pose, 10 * kSceneCheckerSquare, 8 * kSceneCheckerSquare);
    add(find(truth, "poster").pose, 1.1, 1.1);
    addBox(to_view * find(truth, "box").pose);
    ball.center = (to_view * find(truth, "ball").pose).translation();
  }

  void addBox(const cv::Affine3d& pose)
  {
    const double width = 0.34, height = 0.28, depth = 0.28, quarter = CV_PI / 2;
    for (const double side : {-0.5, 0.5})
    {
      rectangles.push_back({pose * cv::Affine3d(cv::Vec3d(0, 0, 0), {0, 0, side * depth}), {width, height}});
      rectangles.push_back({pose * cv::Affine3d(cv::Vec3d(0, quarter, 0), {side * width, 0, 0}), {depth, height}});
      rectangles.push_back({pose * cv::Affine3d(cv::Vec3d(quarter, 0, 0), {0, side * height, 0}), {width, depth}});
    }
  }

  double firstMet(const cv::Vec3d& ray) const
  {
    double z = metAt(ball, ray);
    for (const Rectangle& rectangle : rectangles)
      z = std::min(z, metAt(rectangle, ray));
    return z;
  }

  std::vector<Rectangle> rectangles;
  Ball ball;
};

/// The ray of a pixel, rounded as a table of rays has it.
cv::Vec3d rayOf(const CameraModel& camera, cv::Point pixel)
{
  const cv::Point2d ray = camera.ray(pixel);
  return {static_cast<float>(ray.x), static_cast<float>(ray.y), 1.0};
}

bool sameBits(const cv::Mat& a, const cv::Mat& b)
{
  return a.size() == b.size() && a.type() == b.type() && a.isContinuous() && b.isContinuous() &&
         std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

}  // namespace

TEST(SceneDepth, isThatOfWhatTheRayMeetsFirst)
{
  const int every = 3;  // px
  for (const SceneView view : kViews)
  {
    const CameraModel& camera = sharedScene().camera(view);
    for (const int frame : {0, 250, 480})  // the box is at rest, slides, and is back
    {
      const KnownRoom room(sharedScene(), frame, view);
      const cv::Mat depth = renderedDepth(sharedScene(), frame, view);
      ASSERT_EQ(depth.type(), CV_32FC1);
      ASSERT_EQ(depth.size(), cv::Size(camera.width, camera.height));
      int known = 0;
      for (int y = 0; y < depth.rows; y += every)
        for (int x = 0; x < depth.cols; x += every)
        {
          const double expected = room.firstMet(rayOf(camera, {x, y})), z = depth.at<float>(y, x);
          if (expected < kNothing)
            ASSERT_NEAR(z, expected, kTolerance) << x << ", " << y << " of frame " << frame;
          else
            ASSERT_TRUE(z > 1.0 && z < 3.5) << z << " of a wall at " << x << ", " << y << " of frame " << frame;
          known += expected < kNothing;
        }
      EXPECT_GT(known * every * every, depth.rows * depth.cols / 3);
    }
  }
}

TEST(SceneDepth, hasTheEdgesOfTheColorImage)
{
  const double margin = 1.0;  // px, in which a pixel shows some of both
  for (const int frame : {20, 130, 260})
  {
    const SceneObject ball = find(sharedScene().truth(frame), "ball");
    ASSERT_TRUE(ball.visible) << frame;
    cv::Mat hsv, blue;
    cv::cvtColor(rendered(sharedScene(), frame), hsv, cv::COLOR_BGR2HSV);
    cv::inRange(hsv, cv::Scalar(90, 50, 50), cv::Scalar(120, 255, 255), blue);
    const cv::Mat depth = renderedDepth(sharedScene(), frame, SceneView::kColor);
    const std::vector<cv::Point2f> outline(ball.outline.begin(), ball.outline.end());
    const cv::Rect wider = cv::boundingRect(outline) + cv::Size(8, 8) - cv::Point(4, 4);
    const cv::Rect around = wider & cv::Rect({0, 0}, depth.size());
    int pixels = 0;
    for (int y = around.y; y < around.br().y; ++y)
      for (int x = around.x; x < around.br().x; ++x)
      {
        const cv::Point2f pixel(static_cast<float>(x), static_cast<float>(y));
        if (std::abs(cv::pointPolygonTest(outline, pixel, true)) < margin) continue;
        const cv::Vec3d ray = rayOf(sharedScene().camera(), {x, y});
        const bool on_ball = cv::norm(depth.at<float>(y, x) * ray - ball.pose.translation()) < 1.001 * kSceneBallRadius;
        ASSERT_EQ(on_ball, blue.at<uchar>(y, x) != 0) << x << ", " << y << " of frame " << frame;
        pixels += on_ball;
      }
    EXPECT_GT(pixels, 1000) << frame;
  }
}

TEST(SceneDepth, isNothingWhereNothingIs)
{
  const CalibrationScene scene({320, 240, 2.0});
  const cv::Size2d size(10 * kSceneCheckerSquare, 8 * kSceneCheckerSquare);  // with its margin
  for (const SceneView view : kViews)
  {
    const CameraModel& camera = scene.camera(view);
    int on_board = 0, beside = 0;
    for (const int frame : {0, 3, 8})
    {
      const Rectangle board = {scene.viewPose(view).inv() * scene.truth(frame).objects.at(0).pose, size};
      const cv::Mat depth = renderedDepth(scene, frame, view);
      for (int y = 0; y < depth.rows; ++y)
        for (int x = 0; x < depth.cols; ++x)
        {
          const double expected = metAt(board, rayOf(camera, {x, y})), z = depth.at<float>(y, x);
          if (expected < kNothing)
            ASSERT_NEAR(z, expected, kTolerance) << x << ", " << y;
          else
            ASSERT_TRUE(std::isnan(z)) << x << ", " << y;
          ++(expected < kNothing ? on_board : beside);
        }
    }
    EXPECT_GT(on_board, 5000);
    EXPECT_GT(beside, 5000);
  }
}

TEST(SceneDepth, ofARoadIsThatOfTheGroundAndEndsAtTheHorizon)
{
  const RoadScene scene(withoutNoise(128, 384));  // so high that it shows the sky
  const cv::Affine3d camera_in_world = scene.truth(5).camera;
  const cv::Mat depth = renderedDepth(scene, 5, SceneView::kColor);
  int sky = 0;
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x)
    {
      const cv::Vec3d ray = rayOf(scene.camera(), {x, y}), in_world = camera_in_world.rotation() * ray;
      const double z = depth.at<float>(y, x);
      ASSERT_EQ(std::isnan(z), in_world[2] >= 0.0) << x << ", " << y;
      sky += std::isnan(z);
      const double below = std::isnan(z) ? kSceneCameraHeight : -z * in_world[2];
      ASSERT_NEAR(below / kSceneCameraHeight, 1.0, 1e-5) << x << ", " << y;
    }
  EXPECT_GT(sky, 500);
  EXPECT_GT(depth.rows * depth.cols - sky, 500);
  EXPECT_TRUE(cv::checkRange(renderedDepth(scene, 5), true, nullptr, 0.05, 100.0));  // of 4:3, without sky
}

TEST(SceneDepth, isTheSameInAnyOrderInstanceAndThread)
{
  const Scene one(withoutNoise(160, 120)), other(withoutNoise(160, 120));
  cv::Mat a, b;  // both threads are the first to ask for the rays of the depth camera
  std::thread thread([&] { one.renderDepth(7, a); });
  one.renderDepth(250, b);
  thread.join();
  EXPECT_TRUE(sameBits(renderedDepth(other, 250), b));
  EXPECT_TRUE(sameBits(renderedDepth(other, 7), a));
  EXPECT_FALSE(sameBits(a, b));
  SceneParams params = withoutNoise(160, 120);
  params.noise = 10.0;
  params.seed = 2;
  EXPECT_TRUE(sameBits(renderedDepth(Scene(params), 7), a));
}

TEST(SceneDepth, isWrittenIntoForeignPaddedRowsAndNowhereElse)
{
  const int width = 160, height = 120, padding = 5;
  const Scene scene(withoutNoise(width, height));
  cv::Mat memory(height, width + padding, CV_32FC1, cv::Scalar(-1.0));
  cv::Mat depth = memory.colRange(0, width);
  scene.renderDepth(3, depth);
  EXPECT_EQ(depth.data, memory.data);
  EXPECT_TRUE(sameBits(depth.clone(), renderedDepth(scene, 3)));
  EXPECT_EQ(cv::countNonZero(memory.colRange(width, width + padding) + 1.0), 0);
}
