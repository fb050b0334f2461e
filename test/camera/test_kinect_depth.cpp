#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/camera/kinect_depth.hpp"
#include "support/images.hpp"

using namespace robot_vision;

// A camera and a projector 75 mm beside it see a point at z as far apart as f B / z px. Shifts are eighths of a pixel
// of 640 in a row; that of the plane at 1.2 m is 4 (200 + 0.375).
TEST(KinectDepths, areThoseOfADisparityInStepsOfAnEighthOfAPixel)
{
  const KinectOptics optics;
  EXPECT_NEAR(optics.focalLength(), 575.8, 0.05);  // px, as OpenNI has it
  const double product = optics.focalLength() * 0.075, at_plane = product / 1.2;
  const KinectDepths depths = kinectDepths(optics);
  int measured = 0;
  for (int shift = 0; shift < 2047; ++shift)
  {
    const double disparity = at_plane - (shift - 4 * 200.375) / 8.0, z = product / disparity;
    const bool within = disparity > 0.0 && z < 10.0;
    EXPECT_NEAR(depths[static_cast<std::size_t>(shift)], within ? 1000.0 * z : 0.0, 0.5001) << shift;
    measured += within;
  }
  EXPECT_GT(measured, 1000);
  EXPECT_EQ(depths[2047], 0);
  EXPECT_NEAR(depths[0], 317, 1);  // mm: nothing nearer can be told
}

TEST(KinectDepths, followWhatTheKinectTellsOfItself)
{
  KinectOptics optics;
  optics.zero_shift = 180.0;
  optics.reference_distance = 1.1;
  const KinectDepths depths = kinectDepths(optics);
  const int before = depths[4 * 180 + 1], behind = depths[4 * 180 + 2];  // the plane, by half a step each
  EXPECT_LT(before, 1100);
  EXPECT_GT(behind, 1100);
  EXPECT_NEAR(0.5 * (before + behind), 1100, 1.0);
  EXPECT_TRUE(optics.valid());
  optics.reference_pixel = 0.0;
  EXPECT_FALSE(optics.valid());
  EXPECT_FALSE((KinectOptics{0.075, 1.2, 0.001, std::numeric_limits<double>::quiet_NaN()}.valid()));
}

TEST(KinectDepths, areWrittenIntoTheMemoryTheyAreGiven)
{
  const KinectDepths depths = kinectDepths({});
  cv::Mat shifts = noise({7, 5}, CV_16UC1, 3);
  shifts.at<std::uint16_t>(0, 0) = 800;
  shifts.at<std::uint16_t>(4, 6) = 2047;
  const cv::Mat before = shifts.clone();
  cv::Mat memory(5, 7, CV_16UC1), depth = memory;
  toKinectDepth(shifts, depths, depth);
  EXPECT_EQ(depth.data, memory.data);
  EXPECT_TRUE(equal(shifts, before));
  EXPECT_EQ(depth.at<std::uint16_t>(0, 0), depths[800]);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x)
    {
      const std::uint16_t shift = shifts.at<std::uint16_t>(y, x);
      EXPECT_EQ(depth.at<std::uint16_t>(y, x), shift > 2047 ? 0 : depths[shift]);
    }
  toKinectDepth(cv::Mat(1, 1, CV_16UC1, cv::Scalar(800)), depths, depth);
  EXPECT_EQ(depth.size(), cv::Size(1, 1));
}

TEST(KinectCameras, areThoseOfFreenectsLaunchFiles)
{
  const CameraModel color = kinectColorCamera({640, 480}), large = kinectColorCamera({1280, 1024});
  EXPECT_EQ(color.K, cv::Matx33d(525, 0, 319.5, 0, 525, 239.5, 0, 0, 1));
  EXPECT_EQ(large.K, cv::Matx33d(1050, 0, 639.5, 0, 1050, 479.5, 0, 0, 1));
  const CameraModel depth = kinectDepthCamera({});
  EXPECT_NEAR(depth.K(0, 0), 575.8, 0.05);
  EXPECT_EQ(cv::Point2d(depth.K(0, 2), depth.K(1, 2)), cv::Point2d(314.5, 235.5));
  for (const CameraModel& camera : {color, large, depth})
    EXPECT_NO_THROW(validate(camera));
  EXPECT_EQ(cv::Size(depth.width, depth.height), cv::Size(640, 480));

  const cv::Affine3d to_color = kinectHousing().first_camera, to_depth = to_color * kinectDepthPose();
  EXPECT_LT(cv::norm(to_color.translation() - cv::Vec3d(0, -0.045, 0)), 1e-12);
  EXPECT_LT(cv::norm(to_depth.translation() - cv::Vec3d(0, -0.02, 0)), 1e-12);
  EXPECT_LT(cv::norm(to_color.rotation() * cv::Vec3d(0, 0, 1) - cv::Vec3d(1, 0, 0)), 1e-12);
  EXPECT_LT(cv::norm(to_color.rotation() * cv::Vec3d(1, 0, 0) - cv::Vec3d(0, -1, 0)), 1e-12);
}
