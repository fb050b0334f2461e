#include "robot_vision/depth/tabletop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robot_vision/depth/depth_image.hpp"
#include "robot_vision/scene/depth_noise.hpp"
#include "support/depth_world.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

// A camera that looks down by kPitch.
constexpr double kPitch = 0.6;  // rad
const cv::Vec3d kRight(1.0, 0.0, 0.0);
const cv::Vec3d kAway(0.0, -std::sin(kPitch), std::cos(kPitch));
const cv::Vec3d kUp(0.0, -std::cos(kPitch), -std::sin(kPitch));
const cv::Vec3d kTable(0.0, 0.05, 1.1);  // its middle
const cv::Vec3d kBoxSize(0.2, 0.1, 0.15);
const cv::Vec3d kBox = kTable - 0.22 * kRight + 0.5 * kBoxSize[2] * kUp;  // its middle
constexpr double kBall = 0.05;                                            // radius
const cv::Vec3d kBallMiddle = kTable + 0.2 * kRight + 0.05 * kAway + kBall * kUp;

/// A table above the floor, with a box and a ball on it.
DepthWorld kitchen()
{
  const cv::Vec3d half = 0.5 * kBoxSize;
  DepthWorld world;
  world.rectangles = {{kTable, 0.5 * kRight, 0.3 * kAway},
                      {kTable - 0.75 * kUp, 9.0 * kRight, 9.0 * kAway},
                      {kBox + half[2] * kUp, half[0] * kRight, half[1] * kAway},
                      {kBox - half[1] * kAway, half[0] * kRight, half[2] * kUp},
                      {kBox + half[0] * kRight, half[1] * kAway, half[2] * kUp},
                      {kBox - half[0] * kRight, half[1] * kAway, half[2] * kUp}};
  world.spheres = {{kBallMiddle, kBall}};
  return world;
}

cv::Vec3d axis(const cv::Affine3d& pose, int i)
{
  const cv::Matx33d rotation = pose.rotation();
  return {rotation(0, i), rotation(1, i), rotation(2, i)};
}

/// Expects the table, the box and the ball within a distance (m).
void expectKitchen(const Tabletop& found, double distance)
{
  ASSERT_EQ(found.tables.size(), 2u);  // the floor is one, too
  const Table& table = found.tables[0];
  EXPECT_LT(cv::norm(table.pose.translation() - kTable), distance);
  EXPECT_NEAR(table.size[0], 1.0, distance);
  EXPECT_NEAR(table.size[1], 0.6, distance);
  EXPECT_GT(axis(table.pose, 2).dot(kUp), 0.9999);
  EXPECT_GT(axis(table.pose, 0).dot(kRight), 0.999);
  ASSERT_EQ(table.objects.size(), 2u);
  const TableObject &box = table.objects[0], &ball = table.objects[1];
  EXPECT_LT(cv::norm(box.pose.translation() - kBox), distance);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(box.size[i], kBoxSize[i], distance) << i;
  EXPECT_GT(axis(box.pose, 2).dot(kUp), 0.9999);
  EXPECT_GT(axis(box.pose, 0).dot(kRight), 0.98);
  EXPECT_LT(cv::norm(ball.pose.translation() - kBallMiddle), 0.5 * kBall);  // half of it is seen
  EXPECT_NEAR(ball.size[2], 2.0 * kBall, distance);
}

Tabletop tabletopOf(const cv::Mat& depth, const CameraModel& camera, const cv::Vec3d& up,
                    const TabletopParams& params = TabletopParams())
{
  TabletopFinder finder(camera, PlaneParams(), params);
  Tabletop found = finder.find(depth, depth.type() == CV_16UC1 ? "16UC1" : "32FC1", up);
  found.labels = found.labels.clone();
  return found;
}

}  // namespace

TEST(TabletopFinder, findsATableAndWhatStandsOnIt)
{
  const DepthWorld world = kitchen();
  for (const CameraModel& camera : {depthWorldCamera(320), depthWorldCamera(280, kBentLens)})
  {
    const Tabletop found = tabletopOf(world.depth(camera), camera, 3.0 * kUp);
    expectKitchen(found, 0.015);
    if (HasFatalFailure()) return;
    for (const auto& [object, number] : {std::pair(found.tables[0].objects[0], 1), {found.tables[0].objects[1], 2}})
    {
      const cv::Mat own = found.labels == number;
      EXPECT_EQ(cv::countNonZero(own), object.pixels);
      EXPECT_EQ(cv::countNonZero(own(object.box)), object.pixels);
      const cv::Point2d middle = camera.project(cv::Point3d(object.pose.translation()));
      EXPECT_TRUE(object.box.contains(cv::Point(middle)));
    }
  }
}

TEST(TabletopFinder, findsThemWithTheNoiseOfAKinect)
{
  const CameraModel camera = depthWorldCamera(320);
  cv::Mat noisy, depth;
  DepthNoise(DepthSensor::kKinect, camera, 5).apply(0, kitchen().depth(camera), cv::Mat(), noisy);
  toMillimetres(noisy, "32FC1", depth);
  expectKitchen(tabletopOf(depth, camera, kUp), 0.04);
}

TEST(TabletopFinder, withoutAKnownUpTheLargestPlaneIsTheTable)
{
  DepthWorld world = kitchen();
  world.rectangles[1] = world.rectangles[0];  // no floor
  const CameraModel camera = depthWorldCamera(240);
  const Tabletop found = tabletopOf(world.depth(camera), camera, {});
  ASSERT_EQ(found.tables.size(), 1u);
  EXPECT_EQ(found.tables[0].objects.size(), 2u);
  TabletopParams params;
  params.min_table_area = 2.0;
  EXPECT_TRUE(tabletopOf(world.depth(camera), camera, {}, params).tables.empty());
}

TEST(TabletopFinder, leavesOutAWallThatTheTableEndsAt)
{
  DepthWorld world = kitchen();
  world.rectangles.push_back({kTable + 0.3 * kAway + 0.5 * kUp, 2.0 * kRight, 0.6 * kUp});
  const CameraModel camera = depthWorldCamera(320);
  expectKitchen(tabletopOf(world.depth(camera), camera, kUp), 0.02);
  // A board in the middle of the table, of the same direction, stands on it.
  world.rectangles.push_back({kTable + 0.1 * kUp, 0.06 * kRight, 0.1 * kUp});
  EXPECT_EQ(tabletopOf(world.depth(camera), camera, kUp).tables.at(0).objects.size(), 3u);
}

TEST(TabletopFinder, leavesOutWhatIsTooLowTooHighTooSmallOrNotAboveTheTable)
{
  const CameraModel camera = depthWorldCamera(240);
  const auto objects = [&](const DepthWorld& world, const TabletopParams& params = TabletopParams())
  {
    const Tabletop found = tabletopOf(world.depth(camera), camera, kUp, params);
    return found.tables.empty() ? std::size_t{99} : found.tables[0].objects.size();
  };
  TabletopParams params;
  params.min_height = 0.12;
  EXPECT_EQ(objects(kitchen(), params), 1u);  // the upper part of the box
  params = {};
  params.max_height = 0.05;
  params.min_pixels = 40;
  EXPECT_EQ(objects(kitchen(), params), 2u);  // of both what is lower
  params = {};
  params.min_pixels = 100000;
  EXPECT_EQ(objects(kitchen(), params), 0u);
  params = {};
  params.min_table_area = 2.0;
  EXPECT_EQ(tabletopOf(kitchen().depth(camera), camera, kUp, params).tables.size(), 1u);  // the floor
  DepthWorld beside = kitchen();
  beside.spheres[0].middle += 0.45 * kRight;
  EXPECT_EQ(objects(beside), 1u);
  EXPECT_TRUE(tabletopOf(kitchen().depth(camera), camera, kRight).tables.empty());
}

TEST(TabletopFinder, findsNothingWhereNothingIs)
{
  const CameraModel camera = depthWorldCamera(64);
  for (const cv::Vec3d& up : {kUp, cv::Vec3d()})
  {
    const Tabletop found = tabletopOf(cv::Mat::zeros(48, 64, CV_16UC1), camera, up);
    EXPECT_TRUE(found.tables.empty());
    EXPECT_EQ(cv::countNonZero(found.labels), 0);
    EXPECT_EQ(found.labels.size(), cv::Size(64, 48));
  }
}

TEST(TabletopFinder, whatCannotBeIsRefused)
{
  EXPECT_EQ(refusalWith(&TabletopParams::gap, 0.0), "gap is 0, must be from 0.0001 to 1");
  EXPECT_EQ(refusalWith(&TabletopParams::max_height, 0.005), "max_height is 0.005, must be above min_height, 0.01");
  TabletopFinder finder(depthWorldCamera(64));
  const cv::Mat depth = cv::Mat::zeros(48, 64, CV_16UC1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([&] { finder.find(depth, "16UC1", {0.0, nan, 1.0}); }), "up is nan, must be finite");
  EXPECT_EQ(refusal([&] { finder.find(cv::Mat::zeros(4, 4, CV_16UC1), "16UC1"); }),
            "the size of the depth image is 4x4, must be 64x48 as of its camera");
}
