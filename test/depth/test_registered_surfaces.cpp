#include "robot_vision/depth/depth_registration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "support/depth_world.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

bool sees(float z)
{
  return z > 0.0F;  // not of NaN
}

/// Whether the depth image has a pixel near by of about this depth.
bool isNear(const cv::Mat& truth, int x, int y, int reach, float z, double tolerance)
{
  for (int j = std::max(0, y - reach); j <= std::min(truth.rows - 1, y + reach); ++j)
    for (int i = std::max(0, x - reach); i <= std::min(truth.cols - 1, x + reach); ++i)
      if (std::abs(truth.at<float>(j, i) - z) <= tolerance * z) return true;
  return false;
}

/// Of the pixels of a color camera.
struct Score
{
  int visible = 0;  // see what the depth camera sees, too
  int filled = 0;   // of these, those that have a depth
  int exact = 0;    // of these, those that have the right one
  int wrong = 0;    // pixels that have a depth which nothing near by has
};

Score score(const DepthWorld& world, const cv::Mat& found, const CameraModel& depth_camera,
            const CameraModel& color_camera, const cv::Affine3d& pose, double tolerance = 5e-4)
{
  const cv::Mat truth = world.depth(color_camera, pose);
  const int reach = static_cast<int>(std::ceil(color_camera.K(0, 0) / depth_camera.K(0, 0))) + 1;
  Score result;
  for (int y = 0; y < truth.rows; ++y)
    for (int x = 0; x < truth.cols; ++x)
    {
      const float z = found.at<float>(y, x), expected = truth.at<float>(y, x);
      if (sees(z) && !isNear(truth, x, y, reach, z, 0.01)) ++result.wrong;
      const cv::Point2d ray = color_camera.ray(cv::Point2d(x, y));
      const cv::Vec3d point = pose * (static_cast<double>(expected) * cv::Vec3d(ray.x, ray.y, 1.0));
      const cv::Point2d at = depth_camera.project(cv::Point3d(point));  // NaN where there is nothing
      const bool inside =
          at.x >= 0.0 && at.y >= 0.0 && at.x <= depth_camera.width - 1 && at.y <= depth_camera.height - 1;
      if (!inside) continue;
      const double first = world.hitAt(depth_camera, cv::Affine3d::Identity(), at).distance;
      if (std::abs(first - point[2]) > 1e-4 * point[2]) continue;  // something is before it
      ++result.visible;
      if (!sees(z)) continue;
      ++result.filled;
      if (std::abs(z - expected) <= tolerance * expected) ++result.exact;
    }
  return result;
}

}  // namespace

TEST(RegisteredSurfaces, surfacesAreWhereTheColorCameraSeesThem)
{
  const cv::Affine3d beside = colorPose({0.01, -0.02, 0.005});
  const cv::Affine3d rolled = colorPose({0.0, 0.0, CV_PI / 2.0}, {0.0, 0.03, 0.0});
  const cv::Affine3d slanted = colorPose({0.02, 0.1, 0.5}, {-0.05, 0.02, 0.03});
  struct Case
  {
    CameraModel from, to;
    cv::Affine3d pose;
    double filled;  // share of what both cameras see
  };
  // Where a surface ends between two pixels, up to half a pixel of it may be lost: more of a small image.
  const std::vector<Case> cases = {
      {depthWorldCamera(160), depthWorldCamera(160), beside, 0.99},
      {depthWorldCamera(160, kBentLens), depthWorldCamera(160, kRationalLens, "rational_polynomial"), beside, 0.99},
      {depthWorldCamera(160, kBentLens), depthWorldCamera(160, kFisheyeLens, "equidistant"), slanted, 0.99},
      {depthWorldCamera(160), depthWorldCamera(120, kBentLens), rolled, 0.99},
      {depthWorldCamera(160), depthWorldCamera(72), beside, 0.99},               // fewer pixels
      {depthWorldCamera(160, kBentLens), depthWorldCamera(320), slanted, 0.99},  // twice as many
      {depthWorldCamera(120), depthWorldCamera(360, kBentLens), beside, 0.985},  // three times
      {depthWorldCamera(64), depthWorldCamera(320), beside, 0.975},              // five times
  };
  const DepthWorld world = furnishedWorld();
  for (std::size_t i = 0; i < cases.size(); ++i)
  {
    const auto& [from, to, pose, filled] = cases[i];
    const Score found = score(world, registered(world.depth(from), from, to, pose), from, to, pose);
    EXPECT_GT(found.visible, to.width * to.height / 3) << i;
    EXPECT_GE(found.filled, filled * found.visible) << i;
    EXPECT_GE(found.exact, 0.9 * found.filled) << i;  // not of the ball, whose triangles are flat, and at ends
    EXPECT_LE(found.wrong, 0.001 * to.width * to.height) << i;
  }
}

TEST(RegisteredSurfaces, aSlantedPlaneIsExactInAnyLens)
{
  DepthWorld world;
  world.rectangles = {{{0.0, 0.0, 1.5}, {6.0, 0.0, 5.0}, {0.0, 6.0, -3.0}}};
  const CameraModel from = depthWorldCamera(160, kBentLens);
  const cv::Affine3d pose = colorPose({0.01, -0.02, 0.3}, {0.08, -0.03, 0.02});
  for (const CameraModel& to :
       {depthWorldCamera(96, kRationalLens, "rational_polynomial"), depthWorldCamera(300, kFisheyeLens, "fisheye")})
  {
    const Score found = score(world, registered(world.depth(from), from, to, pose), from, to, pose, 3e-4);
    EXPECT_GT(found.visible, to.width * to.height / 2);
    EXPECT_GE(found.filled, 0.995 * found.visible);
    EXPECT_GE(found.exact, 0.999 * found.filled);
    EXPECT_EQ(found.wrong, 0);
  }
}

TEST(RegisteredSurfaces, whatIsNearHidesWhatIsFarWithoutHoles)
{
  DepthWorld world;
  world.rectangles = {{{0.0, 0.0, 3.0}, {6.0, 0.0, 0.0}, {0.0, 6.0, 0.0}},
                      {{0.0, 0.0, 1.0}, {0.2, 0.0, 0.0}, {0.0, 0.2, 0.0}}};
  const CameraModel from = depthWorldCamera(64);
  const cv::Affine3d pose = colorPose({}, {0.2, 0.0, 0.0});
  for (const int width : {64, 192, 400})
  {
    const CameraModel to = depthWorldCamera(width);
    const cv::Mat found = registered(world.depth(from), from, to, pose), truth = world.depth(to, pose);
    const int ratio = width / 64 + 1;
    const cv::Mat front = truth < 2.0, right = (found > 0.9999) & (found < 1.0001);
    cv::Mat inner;
    cv::erode(front, inner, cv::Mat::ones(2 * ratio + 1, 2 * ratio + 1, CV_8UC1));
    ASSERT_GT(cv::countNonZero(inner), width);
    EXPECT_EQ(cv::countNonZero(inner & ~right), 0) << width;
    // The wall between what the front hides from the one camera and from the other is seen by the color camera alone.
    const int y = to.height / 2;
    const auto column = [&](double x) { return cvRound(to.project(cv::Point3d(x - 0.2, 0.0, 3.0)).x); };
    for (int x = column(0.58) - ratio; x > column(0.58) - 2 * ratio; --x)
      EXPECT_FALSE(sees(found.at<float>(y, x))) << width << " " << x;
    EXPECT_NEAR(found.at<float>(y, column(0.6) + 2 * ratio), 3.0, 1e-3);
  }
}

TEST(RegisteredSurfaces, aSurfaceIsNotSeenFromBehind)
{
  const CameraModel camera = depthWorldCamera(64);
  const cv::Mat wall(camera.height, camera.width, CV_32FC1, cv::Scalar(2.0));
  const cv::Affine3d behind(cv::Vec3d(0.0, CV_PI, 0.0), cv::Vec3d(0.0, 0.0, 4.0));
  EXPECT_EQ(cv::countNonZero(registered(wall, camera, camera, behind) > 0.0), 0);
  const cv::Affine3d before(cv::Vec3d(0.0, 0.0, 0.0), cv::Vec3d(0.0, 0.0, 0.5));
  EXPECT_GT(cv::countNonZero(registered(wall, camera, camera, before) > 0.0), camera.width * camera.height * 99 / 100);
  const cv::Affine3d beyond(cv::Vec3d(0.0, 0.0, 0.0), cv::Vec3d(0.0, 0.0, 3.0));
  EXPECT_EQ(cv::countNonZero(registered(wall, camera, camera, beyond) > 0.0), 0);
}

TEST(RegisteredSurfaces, whatIsFarOutsideOfTheImageIsNotFoldedIntoIt)
{
  DepthWorld world;
  world.rectangles = {{{0.0, 0.0, 1.0}, {9.0, 0.0, 2.0}, {0.0, 9.0, 0.0}}};
  const CameraModel from{96, 72, {24, 0, 47.5, 0, 24, 35.5, 0, 0, 1}, {}, "plumb_bob"};
  const CameraModel to{96, 72, {80, 0, 47.5, 0, 80, 35.5, 0, 0, 1}, {-0.25, 0.0, 0.0, 0.0}, "plumb_bob"};
  const cv::Affine3d pose = colorPose({}, {0.02, 0.0, 0.0});
  const Score found = score(world, registered(world.depth(from), from, to, pose), from, to, pose, 2e-3);
  EXPECT_GT(found.visible, 96 * 72 * 9 / 10);
  EXPECT_EQ(found.wrong, 0);
  EXPECT_GE(found.exact, 0.99 * found.visible);
}

TEST(RegisteredSurfaces, aSinglePixelIsAsLargeAsItWasSeen)
{
  const CameraModel from = depthWorldCamera(64), to = depthWorldCamera(256);
  cv::Mat depth = cv::Mat::zeros(48, 64, CV_16UC1);
  depth.at<std::uint16_t>(20, 30) = 1000;
  const cv::Mat found = registered(depth, from, to, colorPose({}, {}));
  EXPECT_NEAR(cv::countNonZero(found), 16, 9);  // 4x4, or with what is on the border 5x5
  EXPECT_EQ(cv::countNonZero(found == 1000), cv::countNonZero(found));
}

TEST(RegisteredSurfaces, whatCannotBeIsRefused)
{
  const CameraModel camera = depthWorldCamera(64);
  const auto refused = [&](const cv::Affine3d& transform)
  { return refusal([&] { DepthRegistration(camera, camera, transform); }); };
  cv::Affine3d transform = colorPose();
  transform.matrix(0, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refused(transform),
            "the transform from the depth camera to the color camera is nan, must be from -1000 to 1000");
  for (const double factor : {0.0, 2.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
  {
    cv::Affine3d bad;
    bad.rotation(factor * cv::Matx33d::eye());
    EXPECT_EQ(refused(bad),
              "the transform from the depth camera to the color camera is no rotation and translation, "
              "must be that of a rigid body");
  }
  CameraModel wide = camera;
  wide.width = 8193;
  EXPECT_EQ(refusal([&] { DepthRegistration(camera, wide, colorPose()); }),
            "the width of the color camera is 8193, must be from 1 to 8192");
  EXPECT_NE(refusal([&] { DepthRegistration(CameraModel(), camera, colorPose()); }), "");
  EXPECT_EQ(refusalWith(&RegistrationParams::max_jump, 0.0), "max_jump is 0, must be from 0.001 to 1");
  EXPECT_EQ(refusalWith(&RegistrationParams::threads, 0), "threads is 0, must be from 1 to 64");
  DepthRegistration registration(camera, camera, colorPose());
  cv::Mat out;
  EXPECT_EQ(refusal([&] { registration.apply(cv::Mat::zeros(24, 32, CV_16UC1), "16UC1", out); }),
            "the size of the depth image is 32x24, must be 64x48 as of its camera");
}
