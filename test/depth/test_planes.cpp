#include "robot_vision/depth/planes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "robot_vision/depth/depth_image.hpp"
#include "robot_vision/scene/depth_noise.hpp"
#include "support/depth_world.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

PlaneSegmentation planesOf(const cv::Mat& depth, const CameraModel& camera, const PlaneParams& params = PlaneParams())
{
  PlaneFinder finder(camera, params);
  PlaneSegmentation found = finder.find(depth, depth.type() == CV_16UC1 ? "16UC1" : "32FC1");
  found.labels = found.labels.clone();
  return found;
}

double degreesBetween(const cv::Vec3d& a, const cv::Vec3d& b)
{
  return std::atan2(cv::norm(a.cross(b)), a.dot(b)) * 180.0 / CV_PI;
}

/// The normal of a rectangle that points to the camera.
cv::Vec3d normalOf(const WorldRectangle& rectangle)
{
  const cv::Vec3d normal = cv::normalize(rectangle.right.cross(rectangle.down));
  return normal.dot(rectangle.middle) > 0.0 ? -1.0 * normal : normal;
}

/// Expects that a plane is that of a rectangle: the angle in degrees, the distance in m.
void expectPlane(const Plane& plane, const WorldRectangle& rectangle, double angle, double distance)
{
  const cv::Vec3d normal = normalOf(rectangle);
  EXPECT_LT(degreesBetween(plane.normal, normal), angle);
  EXPECT_NEAR(cv::norm(plane.normal), 1.0, 1e-9);
  EXPECT_NEAR(normal.dot(cv::Vec3d(plane.center) - rectangle.middle), 0.0, distance);
  EXPECT_NEAR(plane.normal.dot(cv::Vec3d(plane.center)) + plane.distance, 0.0, 1e-3);
}

/// A floor, a wall and a board before the wall.
DepthWorld corner()
{
  DepthWorld world;
  world.rectangles = {{{0.0, 0.0, 2.5}, {9.0, 0.0, 2.0}, {0.0, 9.0, 0.0}},
                      {{0.0, 0.6, 2.0}, {9.0, 0.0, 0.0}, {0.0, 0.5, -2.0}},
                      {{-0.3, -0.2, 1.7}, {0.3, 0.0, -0.1}, {0.0, 0.3, 0.1}}};
  return world;
}

}  // namespace

TEST(PlaneFinder, findsThePlanesOfARoom)
{
  const DepthWorld world = corner();
  for (const CameraModel& camera : {depthWorldCamera(160), depthWorldCamera(200, kBentLens)})
  {
    const PlaneSegmentation found = planesOf(world.depth(camera), camera);
    ASSERT_EQ(found.planes.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i)
    {
      const auto angle = [&](const WorldRectangle& of) { return degreesBetween(found.planes[i].normal, normalOf(of)); };
      const auto nearest = std::min_element(world.rectangles.begin(), world.rectangles.end(),
                                            [&](const auto& a, const auto& b) { return angle(a) < angle(b); });
      expectPlane(found.planes[i], *nearest, 0.05, 5e-4);
      EXPECT_LT(found.planes[i].deviation, 0.2);
      EXPECT_EQ(found.planes[i].pixels, cv::countNonZero(found.labels == static_cast<double>(i + 1)));
      EXPECT_TRUE(i == 0 || found.planes[i - 1].pixels >= found.planes[i].pixels);
    }
    EXPECT_GT(cv::countNonZero(found.labels), camera.width * camera.height * 9 / 10);
  }
}

TEST(PlaneFinder, isExactWithTheNoiseOfAKinect)
{
  const CameraModel camera = depthWorldCamera(640);
  DepthWorld world;
  world.rectangles = {{{0.05, 0.1, 1.4}, {0.7, 0.1, 0.0}, {0.0, 0.35, -0.5}}};
  cv::Mat noisy, depth;
  DepthNoise(DepthSensor::kKinect, camera, 3).apply(0, world.depth(camera), cv::Mat(), noisy);
  toMillimetres(noisy, "32FC1", depth);
  const PlaneSegmentation found = planesOf(depth, camera);
  ASSERT_EQ(found.planes.size(), 1u);
  expectPlane(found.planes[0], world.rectangles[0], 0.2, 2e-3);
  EXPECT_NEAR(found.planes[0].deviation, 1.0, 0.5);
}

TEST(PlaneFinder, theHullIsThatOfWhatIsSeen)
{
  const CameraModel camera = depthWorldCamera(240);
  DepthWorld world;
  world.rectangles = {{{0.05, 0.02, 1.5}, {0.4, 0.1, 0.1}, {-0.05, 0.3, -0.1}}};
  const WorldRectangle& board = world.rectangles[0];
  const PlaneSegmentation found = planesOf(world.depth(camera), camera);
  ASSERT_EQ(found.planes.size(), 1u);
  const Plane& plane = found.planes[0];
  const double pixel = 1.5 / camera.K(0, 0);  // m
  for (const int right : {-1, 1})
    for (const int down : {-1, 1})
    {
      const cv::Vec3d expected = board.middle + right * board.right + down * board.down;
      double nearest = 1.0;
      for (const cv::Point3d& at : plane.hull)
        nearest = std::min(nearest, cv::norm(cv::Vec3d(at) - expected));
      EXPECT_LT(nearest, 4.0 * pixel);
    }
  double area = 0.0;  // of the triangles around the first corner, counter-clockwise for the camera
  for (std::size_t i = 2; i < plane.hull.size(); ++i)
    area += 0.5 * plane.normal.dot(
                      cv::Vec3d(plane.hull[i - 1] - plane.hull[0]).cross(cv::Vec3d(plane.hull[i] - plane.hull[0])));
  EXPECT_NEAR(area, 4.0 * cv::norm(board.right.cross(board.down)), 0.03);
  for (const cv::Point3d& at : plane.hull)
    EXPECT_NEAR(plane.normal.dot(cv::Vec3d(at)) + plane.distance, 0.0, 1e-5);
}

TEST(PlaneFinder, aPlaneBehindSomethingIsOne)
{
  const CameraModel camera = depthWorldCamera(160);
  DepthWorld world;
  world.rectangles = {{{0.0, 0.0, 2.0}, {9.0, 0.0, 2.0}, {0.0, 9.0, 0.0}},
                      {{0.1, 0.0, 1.0}, {0.1, 0.0, 0.0}, {0.0, 2.0, 0.0}}};
  const PlaneSegmentation found = planesOf(world.depth(camera), camera);
  ASSERT_EQ(found.planes.size(), 2u);
  expectPlane(found.planes[0], world.rectangles[0], 0.05, 5e-4);
  expectPlane(found.planes[1], world.rectangles[1], 0.05, 5e-4);
  world.rectangles[0] = {
      {0.9, 0.0, 2.0}, {0.7, 0.0, 0.0}, {0.0, 9.0, 0.0}};  // on the right only, and farther on the left
  world.rectangles.push_back({{-0.9, 0.0, 2.1}, {0.9, 0.0, 0.0}, {0.0, 9.0, 0.0}});
  EXPECT_EQ(planesOf(world.depth(camera), camera).planes.size(), 3u);
}

TEST(PlaneFinder, aPlaneMayBeSeenInPiecesSmallerThanTheSmallest)
{
  const CameraModel camera = depthWorldCamera(160);
  DepthWorld world;
  world.rectangles = {{{0.0, 0.0, 2.0}, {9.0, 0.0, 2.0}, {0.0, 9.0, 0.0}}};
  for (const double x : {-0.2, 0.2})
    world.rectangles.push_back({{x, 0.0, 1.0}, {0.04, 0.0, 0.0}, {0.0, 2.0, 0.0}});
  PlaneParams params;
  params.min_area = 0.4;
  const PlaneSegmentation found = planesOf(world.depth(camera), camera, params);
  ASSERT_EQ(found.planes.size(), 1u);
  expectPlane(found.planes[0], world.rectangles[0], 0.05, 5e-4);
  EXPECT_GT(found.planes[0].pixels, camera.width * camera.height * 7 / 10);
}

TEST(PlaneFinder, whatIsRoundOrWithoutDepthIsNoPlane)
{
  const CameraModel camera = depthWorldCamera(120);
  DepthWorld world;
  world.spheres = {{{0.0, 0.0, 0.9}, 0.35}};
  PlaneParams exact;
  exact.noise = 0.0002;
  exact.min_noise = 0.0001;
  exact.min_area = 0.05;
  EXPECT_TRUE(planesOf(world.depth(camera), camera, exact).planes.empty());
  const cv::Size size(camera.width, camera.height);
  for (const float value : {kNan, 0.0F, std::numeric_limits<float>::infinity()})
  {
    const PlaneSegmentation found = planesOf(cv::Mat(size, CV_32FC1, cv::Scalar(value)), camera);
    EXPECT_TRUE(found.planes.empty());
    EXPECT_EQ(cv::countNonZero(found.labels), 0);
  }
  const CameraModel single{1, 1, {50, 0, 0, 0, 50, 0, 0, 0, 1}, {}, "plumb_bob"};
  EXPECT_TRUE(planesOf(cv::Mat(1, 1, CV_16UC1, cv::Scalar(900)), single).planes.empty());
}

TEST(PlaneFinder, theHullEndsBeforeTheHorizon)
{
  const CameraModel camera = depthWorldCamera(160);
  constexpr double kHeight = 20.0;  // m, above a floor that is seen as far as 4 km away
  cv::Mat depth(camera.height, camera.width, CV_32FC1, cv::Scalar(kNan));
  for (int y = 0; y < depth.rows; ++y)
    if (const double down = (y - camera.K(1, 2)) / camera.K(1, 1); down > 0.0)
      depth.row(y).setTo(cv::Scalar(kHeight / down));
  double farthest = 0.0;
  cv::minMaxLoc(depth, nullptr, &farthest, nullptr, nullptr, depth == depth);
  ASSERT_GT(farthest, 3000.0);
  const PlaneSegmentation found = planesOf(depth, camera);
  ASSERT_EQ(found.planes.size(), 1u);
  EXPECT_LT(degreesBetween(found.planes[0].normal, {0.0, -1.0, 0.0}), 0.1);
  EXPECT_NEAR(found.planes[0].distance, kHeight, 0.1);
  ASSERT_GE(found.planes[0].hull.size(), 4u);
  for (const cv::Point3d& at : found.planes[0].hull)
    EXPECT_TRUE(at.z > 10.0 && at.z <= 1000.0) << at;
}

TEST(PlaneFinder, ofVeryManySurfacesItFindsThoseThatAreWanted)
{
  const CameraModel camera = depthWorldCamera(640);
  cv::Mat blocks(60, 80, CV_16UC1), depth;
  cv::RNG random(1);
  random.fill(blocks, cv::RNG::UNIFORM, 800, 5000);
  cv::resize(blocks, depth, cv::Size(640, 480), 0, 0, cv::INTER_NEAREST);
  PlaneParams params;
  params.min_area = 0.0001;
  params.max_planes = 100;
  const PlaneSegmentation found = planesOf(depth, camera, params);
  ASSERT_EQ(found.planes.size(), 100u);
  for (std::size_t i = 0; i < found.planes.size(); ++i)
    EXPECT_EQ(found.planes[i].pixels, cv::countNonZero(found.labels == static_cast<double>(i + 1))) << i;
  random.fill(depth, cv::RNG::UNIFORM, 0, 65536);
  EXPECT_TRUE(planesOf(depth, camera).planes.empty());
}

TEST(PlaneFinder, findsAsManyAsAreWanted)
{
  const CameraModel camera = depthWorldCamera(160);
  const cv::Mat depth = corner().depth(camera);
  PlaneParams params;
  params.max_planes = 1;
  const PlaneSegmentation one = planesOf(depth, camera, params), all = planesOf(depth, camera);
  ASSERT_EQ(one.planes.size(), 1u);
  EXPECT_LT(cv::norm(one.planes[0].normal - all.planes[0].normal), 1e-3);
  EXPECT_EQ(cv::countNonZero(one.labels > 1), 0);
  params = PlaneParams();
  params.min_area = 0.9;
  EXPECT_TRUE(planesOf(depth, camera, params).planes.empty());
}

TEST(PlaneFinder, framesDoNotDependOnThoseBefore)
{
  const CameraModel camera = depthWorldCamera(120);
  const cv::Mat depth = corner().depth(camera);
  PlaneFinder finder(camera);
  finder.find(cv::Mat(depth.size(), CV_32FC1, cv::Scalar(2.0)), "32FC1");
  const PlaneSegmentation& found = finder.find(depth, "32FC1");
  const PlaneSegmentation expected = planesOf(depth, camera);
  ASSERT_EQ(found.planes.size(), expected.planes.size());
  EXPECT_EQ(cv::countNonZero(found.labels != expected.labels), 0);
  for (std::size_t i = 0; i < found.planes.size(); ++i)
    EXPECT_EQ(found.planes[i].normal, expected.planes[i].normal);
}

TEST(PlaneFinder, whatCannotBeIsRefused)
{
  EXPECT_EQ(refusalWith(&PlaneParams::noise, -0.1), "noise is -0.1, must be from 0 to 1");
  EXPECT_EQ(refusalWith(&PlaneParams::min_area, 0.0), "min_area is 0, must be from 0.0001 to 1");
  EXPECT_EQ(refusalWith(&PlaneParams::max_planes, 101), "max_planes is 101, must be from 1 to 100");
  PlaneFinder finder(depthWorldCamera(64));
  EXPECT_EQ(refusal([&] { finder.find(cv::Mat::zeros(4, 4, CV_16UC1), "16UC1"); }),
            "the size of the depth image is 4x4, must be 64x48 as of its camera");
}
