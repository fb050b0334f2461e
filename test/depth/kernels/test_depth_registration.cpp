#include "robot_vision/depth/depth_registration.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/simd/instruction_sets.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "support/depth_world.hpp"
#include "support/images.hpp"

using namespace robot_vision;

namespace
{

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Depths without any order, many without one.
cv::Mat scattered(const cv::Size& size)
{
  cv::Mat depth = noise(size, CV_16UC1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if ((x * 7 + y * 3) % 5 == 0) depth.at<std::uint16_t>(y, x) = 0;
  return depth;
}

}  // namespace

TEST(DepthRegistration, aCameraInTheSamePlaceSeesTheSame)
{
  const std::vector<std::pair<std::vector<double>, std::string>> lenses = {{{}, "plumb_bob"},
                                                                           {kBentLens, "plumb_bob"},
                                                                           {kRationalLens, "rational_polynomial"},
                                                                           {kFisheyeLens, "equidistant"}};
  for (const auto& [D, model] : lenses)
    for (const int width : {64, 71, 4})
    {
      const CameraModel camera = depthWorldCamera(width, D, model);
      const cv::Mat depth = scattered({camera.width, camera.height}), before = depth.clone();
      EXPECT_TRUE(equal(registered(depth, camera, camera, colorPose({}, {})), depth)) << model << " " << width;
      EXPECT_TRUE(equal(depth, before));
    }
}

TEST(DepthRegistration, bothEncodingsGiveTheSame)
{
  const CameraModel from = depthWorldCamera(96), to = depthWorldCamera(131, kBentLens);
  const cv::Mat metres = furnishedWorld().depth(from);
  cv::Mat millimetres, rounded, expected;
  toMillimetres(metres, "32FC1", millimetres);
  toMetres(millimetres, "16UC1", rounded);
  toMillimetres(registered(rounded, from, to, colorPose()), "32FC1", expected);
  EXPECT_TRUE(equal(registered(millimetres, from, to, colorPose()), expected));
  cv::Mat of_mono;
  DepthRegistration(from, to, colorPose().inv()).apply(millimetres, "mono16", of_mono);
  EXPECT_TRUE(equal(of_mono, expected));
}

TEST(DepthRegistration, threadsAndInstructionSetsChangeNothing)
{
  const InstructionSet chosen = currentSet();
  const DepthWorld world = furnishedWorld();
  for (const int width : {64, 150, 290, 500})
  {
    const CameraModel from = depthWorldCamera(97, kBentLens), to = depthWorldCamera(width, kFisheyeLens, "equidistant");
    cv::Mat depth;
    toMillimetres(world.depth(from), "32FC1", depth);
    scattered(cv::Size(40, 30)).copyTo(depth({20, 20, 40, 30}));
    const cv::Affine3d pose = colorPose({0.02, 0.01, 0.4}, {0.06, 0.01, 0.0});
    chooseSet(InstructionSet::kBaseline);
    const cv::Mat expected = registered(depth, from, to, pose);
    chooseSet(chosen);
    for (const int threads : {1, 2, 5})
    {
      RegistrationParams params;
      params.threads = threads;
      EXPECT_TRUE(equal(registered(depth, from, to, pose, params), expected)) << width << " " << threads;
    }
  }
}

TEST(DepthRegistration, framesDoNotDependOnThoseBefore)
{
  const CameraModel from = depthWorldCamera(64), to = depthWorldCamera(150);
  DepthRegistration registration(from, to, colorPose().inv());
  const cv::Mat first = scattered({64, 48});
  cv::Mat second, result;
  toMillimetres(furnishedWorld().depth(from), "32FC1", second);
  for (const cv::Mat& depth : {first, second, first})
  {
    registration.apply(depth, "16UC1", result);
    EXPECT_TRUE(equal(result, registered(depth, from, to, colorPose())));
  }
  const cv::Affine3d moved = colorPose({0.0, 0.1, 0.0}, {-0.1, 0.0, 0.0});
  registration.setTransform(moved.inv());
  registration.apply(second, "16UC1", result);
  EXPECT_TRUE(equal(result, registered(second, from, to, moved)));
}

TEST(DepthRegistration, withoutDepthsThereIsNothing)
{
  const CameraModel from = depthWorldCamera(64), to = depthWorldCamera(90);
  for (const float value : {0.0F, kNan, std::numeric_limits<float>::infinity(), -2.0F, 1e-5F, 1e20F})
  {
    const cv::Mat found = registered(cv::Mat(48, 64, CV_32FC1, cv::Scalar(value)), from, to, colorPose());
    EXPECT_EQ(cv::countNonZero(found == found), 0) << value;  // NaN everywhere
  }
  EXPECT_EQ(cv::countNonZero(registered(cv::Mat::zeros(48, 64, CV_16UC1), from, to, colorPose())), 0);
  const CameraModel single{1, 1, {10, 0, 0, 0, 10, 0, 0, 0, 1}, {}, "plumb_bob"};
  EXPECT_EQ(registered(cv::Mat(1, 1, CV_16UC1, cv::Scalar(900)), single, to, colorPose()).size(), cv::Size(90, 67));
}
