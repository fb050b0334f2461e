// The places of regions against the truth, with the noise of sensors, and the covariances of their errors.

#include <gtest/gtest.h>

#include <cmath>

#include "robot_vision/depth/region_depth.hpp"
#include "robot_vision/scene/depth_noise.hpp"
#include "support/depth_regions.hpp"

using namespace robot_vision;
using namespace depth_regions;

TEST(RegionLocator, aFaceAndABallAreFoundWithTheNoiseOfEverySensor)
{
  const WorldSphere ball = {{-0.45, 0.25, 1.4}, 0.12};
  DepthWorld world = faceBeforeAWall();
  world.spheres = {ball};
  const CameraModel camera = depthWorldCamera(320, kBentLens);
  const cv::Mat exact = world.depth(camera);
  for (const char* name : {"none", "kinect", "stereo", "tof"})
    for (const double brightness : {128.0, 24.0})  // of which many pixels have no depth
    {
      cv::Mat noisy;
      const cv::Mat light(exact.size(), CV_8UC1, cv::Scalar(brightness));
      DepthNoise(depthSensor(name), camera, 3).apply(1, exact, light, noisy);
      const auto face = locate(noisy, camera, faceBox(camera));
      const auto middle = locate(noisy, camera, circleOf(ball, camera), sphere());
      ASSERT_TRUE(face && middle) << name;
      EXPECT_LT(squaredError(kFace, *face), 14.2) << name;  // that of 99.7 %
      EXPECT_LT(squaredError(ball.middle, *middle), 14.2) << name;
      EXPECT_LT(std::abs(face->position.z - kFace[2]), 0.02) << name;
      EXPECT_LT(std::abs(middle->position.z - ball.middle[2]), 0.02) << name;
      EXPECT_LT(face->size[2], 0.06) << name;  // it is flat, and stereo has more noise than is told
    }
}

namespace
{

/// Makes depths of a sensor as `errors` describe it, with noise that no pixels share.
cv::Mat measured(const cv::Mat& exact, const DepthErrorParams& errors, cv::RNG& random)
{
  const double bias = random.gaussian(errors.depth_bias);
  cv::Mat depth(exact.size(), CV_32FC1);
  for (int i = 0; i < static_cast<int>(exact.total()); ++i)
  {
    const double z = exact.at<float>(i);
    const double sigma = std::sqrt(std::pow(depthDeviation(z, errors), 2) - std::pow(stepDeviation(z, errors), 2));
    const double steps = 1.0 / (z + bias + random.gaussian(sigma)) / errors.depth_step;
    depth.at<float>(i) = static_cast<float>(1.0 / (std::round(steps) * errors.depth_step));
  }
  return depth;
}

/// The mean squared error, in its variances, of what a detector says that is as inexact as the parameters tell.
double meanSquaredError(const DepthWorld& world, const cv::Vec3d& truth, const ImageRegion& region,
                        const LocatorParams& params)
{
  constexpr int kTrials = 150;
  const CameraModel camera = depthWorldCamera(320);
  DepthErrorParams errors;
  errors.depth_correlation = 1;
  const RegionLocator locator(camera, params, errors);
  const cv::Mat exact = world.depth(camera);
  const cv::Point2d center = camera.project(cv::Point3d(truth));
  cv::RNG random(11);
  double sum = 0.0;
  for (int i = 0; i < kTrials; ++i)
  {
    ImageRegion inexact = region;
    const auto deviation = [&](int side) { return std::hypot(params.pixel_error, params.box_error * side); };
    const cv::Point2d off(random.gaussian(deviation(region.box.width)), random.gaussian(deviation(region.box.height)));
    inexact.center = center + off;
    inexact.box += cv::Point(off);
    if (region.radius > 0.0)
      inexact.radius += random.gaussian(std::hypot(params.pixel_error, params.box_error * region.radius));
    const auto found = locator.locate(measured(exact, errors, random), "32FC1", inexact);
    sum += squaredError(truth, *found) / kTrials;
  }
  return sum;
}

}  // namespace

// The mean of 150 squared errors in three dimensions is 3, with a standard deviation of 0.2. What the parameters tell
// is the most that is to be expected of a sensor's steps.
TEST(RegionLocator, theCovarianceOfAFaceIsThatOfItsErrors)
{
  const double error = meanSquaredError(faceBeforeAWall(), kFace, faceBox(depthWorldCamera(320)), {});
  EXPECT_GT(error, 2.0);
  EXPECT_LT(error, 3.8);
}

TEST(RegionLocator, theCovarianceOfASlantedBoardIsNotTooSmall)
{
  const cv::Vec3d middle(0.1, 0.1, 1.5);
  DepthWorld world;
  world.rectangles = {kWall, {middle, {0.15, 0.0, 0.15}, {0.0, 0.15, 0.0}}};
  const ImageRegion region = boxOf(middle, 0.3, 0.3, depthWorldCamera(320));
  const double error = meanSquaredError(world, middle, region, {});
  EXPECT_GT(error, 1.5);
  EXPECT_LT(error, 4.5);
}

TEST(RegionLocator, theCovarianceOfTheMiddleOfASphereIsThatOfItsErrors)
{
  const WorldSphere ball = {{-0.1, 0.1, 1.2}, 0.12};
  DepthWorld world;
  world.rectangles = {kWall};
  world.spheres = {ball};
  const double error = meanSquaredError(world, ball.middle, circleOf(ball, depthWorldCamera(320)), sphere());
  EXPECT_GT(error, 1.5);
  EXPECT_LT(error, 4.5);
}
