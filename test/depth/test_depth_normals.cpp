#include "robot_vision/depth/depth_normals.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "robot_vision/depth/depth_image.hpp"
#include "support/depth_world.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

cv::Mat normalsOf(const cv::Mat& depth, const CameraModel& camera, const NormalParams& params = NormalParams())
{
  cv::Mat normals;
  DepthNormals(camera, params).apply(depth, depth.type() == CV_16UC1 ? "16UC1" : "32FC1", normals);
  return normals;
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

int countOf(const cv::Mat& normals)
{
  int count = 0;
  for (int y = 0; y < normals.rows; ++y)
    for (int x = 0; x < normals.cols; ++x)
      count += std::isnan(normals.at<cv::Vec3f>(y, x)[0]) ? 0 : 1;
  return count;
}

}  // namespace

TEST(DepthNormals, ofAPlaneAreItsOwnInAnyLens)
{
  DepthWorld world;
  world.rectangles = {{{0.0, 0.0, 2.0}, {9.0, 0.0, 5.0}, {0.0, 9.0, -3.0}}};
  const cv::Vec3d expected = normalOf(world.rectangles[0]);
  NormalParams params;
  for (const CameraModel& camera :
       {depthWorldCamera(96), depthWorldCamera(80, kBentLens), depthWorldCamera(64, kFisheyeLens, "equidistant")})
    for (const int radius : {1, 3, 8})
    {
      params.radius = radius;
      const cv::Mat normals = normalsOf(world.depth(camera), camera, params);
      EXPECT_EQ(countOf(normals), (camera.width - 2) * (camera.height - 2));  // not of the border
      for (int y = 1; y + 1 < normals.rows; ++y)
        for (int x = 1; x + 1 < normals.cols; ++x)
        {
          const cv::Vec3d normal = normals.at<cv::Vec3f>(y, x);
          ASSERT_NEAR(cv::norm(normal), 1.0, 1e-5);
          ASSERT_LT(degreesBetween(normal, expected), camera.D.empty() ? 0.1 : 1.5) << x << " " << y << " " << radius;
        }
    }
}

TEST(DepthNormals, ofABallPointAwayFromItsMiddle)
{
  DepthWorld world;
  world.spheres = {{{0.1, 0.05, 1.5}, 0.5}};
  const CameraModel camera = depthWorldCamera(160);
  const cv::Mat depth = world.depth(camera);
  NormalParams params;
  params.radius = 2;
  const cv::Mat normals = normalsOf(depth, camera, params);
  int checked = 0;
  for (int y = 0; y < normals.rows; ++y)
    for (int x = 0; x < normals.cols; ++x)
    {
      const cv::Vec3d normal = normals.at<cv::Vec3f>(y, x);
      if (std::isnan(normal[0])) continue;
      const cv::Point2d ray = camera.ray(cv::Point2d(x, y));
      const cv::Vec3d point = static_cast<double>(depth.at<float>(y, x)) * cv::Vec3d(ray.x, ray.y, 1.0);
      const cv::Vec3d expected = cv::normalize(point - world.spheres[0].middle);
      EXPECT_LT(normal.dot(point), 0.0) << x << " " << y;
      if (expected.dot(cv::normalize(point)) > -0.5) continue;  // seen at a grazing angle: much of it in one square
      EXPECT_LT(degreesBetween(normal, expected), 2.0) << x << " " << y;
      ++checked;
    }
  EXPECT_GT(checked, 2000);
}

TEST(DepthNormals, areOfOneSurfaceBesideAJump)
{
  DepthWorld world;
  world.rectangles = {{{0.0, 0.0, 2.5}, {9.0, 0.0, 3.0}, {0.0, 9.0, 0.0}},
                      {{0.1, 0.0, 1.2}, {0.3, 0.0, 0.0}, {0.0, 0.25, 0.15}}};
  const CameraModel camera = depthWorldCamera(120);
  const cv::Mat depth = world.depth(camera), normals = normalsOf(depth, camera);
  const cv::Vec3d far = normalOf(world.rectangles[0]), near = normalOf(world.rectangles[1]);
  for (int y = 0; y < normals.rows; ++y)
    for (int x = 0; x < normals.cols; ++x)
    {
      const cv::Vec3d normal = normals.at<cv::Vec3f>(y, x);
      if (std::isnan(normal[0])) continue;
      const bool is_near = depth.at<float>(y, x) < 1.6F;
      ASSERT_LT(degreesBetween(normal, is_near ? near : far), 0.5) << x << " " << y;
    }
  // All but two pixels at both sides of the jump, and one along the border.
  EXPECT_GT(countOf(normals), camera.width * camera.height * 85 / 100);
}

TEST(DepthNormals, areNoneWhereNoSurfaceIs)
{
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(2, 2), cv::Size(2, 9), cv::Size(64, 48)})
  {
    const CameraModel camera{size.width, size.height, {50, 0, 1, 0, 50, 1, 0, 0, 1}, {}, "plumb_bob"};
    EXPECT_EQ(countOf(normalsOf(cv::Mat(size, CV_32FC1, cv::Scalar(kNan)), camera)), 0);
    EXPECT_EQ(countOf(normalsOf(cv::Mat(size, CV_16UC1, cv::Scalar(0)), camera)), 0);
    const int expected = std::max(0, size.width - 2) * std::max(0, size.height - 2);
    EXPECT_EQ(countOf(normalsOf(cv::Mat(size, CV_16UC1, cv::Scalar(1500)), camera)), expected) << size;
  }
  // Every other pixel has another depth.
  cv::Mat chess(48, 64, CV_16UC1);
  for (int y = 0; y < chess.rows; ++y)
    for (int x = 0; x < chess.cols; ++x)
      chess.at<std::uint16_t>(y, x) = (x + y) % 2 == 0 ? 1000 : 2000;
  EXPECT_EQ(countOf(normalsOf(chess, depthWorldCamera(64))), 0);
}

TEST(DepthNormals, doNotDependOnThreadsAndEarlierFrames)
{
  const CameraModel camera = depthWorldCamera(120);
  const cv::Mat depth = furnishedWorld().depth(camera), expected = normalsOf(depth, camera);
  NormalParams params;
  params.threads = 3;
  DepthNormals finder(camera, params);
  cv::Mat normals;
  finder.apply(cv::Mat(depth.size(), CV_32FC1, cv::Scalar(2.0)), "32FC1", normals);
  finder.apply(depth, "32FC1", normals);
  for (int y = 0; y < depth.rows; ++y)
    EXPECT_EQ(std::memcmp(normals.ptr(y), expected.ptr(y), depth.cols * sizeof(cv::Vec3f)), 0) << y;
}

TEST(DepthNormals, whatCannotBeIsRefused)
{
  EXPECT_EQ(refusalWith(&NormalParams::radius, 0), "radius is 0, must be from 1 to 50");
  EXPECT_EQ(refusalWith(&NormalParams::max_jump, 2.0), "max_jump is 2, must be from 0.001 to 1");
  EXPECT_EQ(refusalWith(&NormalParams::threads, 65), "threads is 65, must be from 1 to 64");
  DepthNormals finder(depthWorldCamera(64));
  cv::Mat out;
  EXPECT_EQ(refusal([&] { finder.apply(cv::Mat::zeros(4, 4, CV_16UC1), "16UC1", out); }),
            "the size of the depth image is 4x4, must be 64x48 as of its camera");
  EXPECT_NE(refusal([&] { finder.apply(cv::Mat::zeros(48, 64, CV_8UC1), "mono8", out); }), "");
}
