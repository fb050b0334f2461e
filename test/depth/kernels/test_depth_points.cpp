#include "robot_vision/depth/depth_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "robot_vision/depth/depth_image.hpp"
#include "support/depth_world.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// Depths from 0.5 to 6 m, none in every seventh pixel, in rows that are followed by other numbers.
cv::Mat depths(const cv::Size& size, int type)
{
  cv::Mat padded(size.height, size.width + 3, type, cv::Scalar(9));
  cv::Mat image = padded.colRange(0, size.width);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
    {
      const int mm = (x + 3 * y) % 7 == 0 ? 0 : 500 + (x * 37 + y * 101) % 5500;
      if (type == CV_16UC1)
        image.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(mm);
      else
        image.at<float>(y, x) = mm == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(mm) / 1000.0F;
    }
  return image;
}

std::string encodingOf(const cv::Mat& depth)
{
  return depth.type() == CV_16UC1 ? "16UC1" : "32FC1";
}

bool sameBytes(const cv::Mat& a, const cv::Mat& b)
{
  for (int y = 0; y < a.rows; ++y)
    if (std::memcmp(a.ptr(y), b.ptr(y), a.cols * a.elemSize()) != 0) return false;
  return a.size() == b.size() && a.type() == b.type();
}

std::uint32_t bits(float value)
{
  std::uint32_t result = 0;
  std::memcpy(&result, &value, sizeof(result));
  return result;
}

}  // namespace

TEST(DepthPoints, pointsAreOnTheRaysOfTheirPixels)
{
  const std::vector<double> bent = {-0.28, 0.09, 0.001, -0.002, 0.01}, fisheye = {0.05, -0.02, 0.006, -0.001};
  for (const CameraModel& camera : {depthWorldCamera(64), depthWorldCamera(37, bent),
                                    depthWorldCamera(48, fisheye, "equidistant"), depthWorldCamera(2)})
    for (const int type : {CV_16UC1, CV_32FC1})
    {
      const cv::Mat depth = depths({camera.width, camera.height}, type), before = depth.clone();
      cv::Mat points, metres;
      DepthPoints(camera).points(depth, encodingOf(depth), points);
      toMetres(depth, encodingOf(depth), metres);
      ASSERT_EQ(points.type(), CV_32FC3);
      ASSERT_EQ(points.size(), depth.size());
      for (int y = 0; y < depth.rows; ++y)
        for (int x = 0; x < depth.cols; ++x)
        {
          const cv::Vec3f point = points.at<cv::Vec3f>(y, x);
          const double z = metres.at<float>(y, x);
          if (std::isnan(z))
          {
            EXPECT_TRUE(std::isnan(point[0]) && std::isnan(point[1]) && std::isnan(point[2])) << x << " " << y;
            continue;
          }
          const cv::Point2d ray = camera.ray(cv::Point2d(x, y));
          EXPECT_LT(cv::norm(cv::Vec3d(point) - z * cv::Vec3d(ray.x, ray.y, 1.0)), 1e-6 * z) << x << " " << y;
        }
      EXPECT_TRUE(sameBytes(depth, before));
    }
}

TEST(DepthPoints, aCloudHasAFourthNumber)
{
  const CameraModel camera = depthWorldCamera(61);
  const cv::Mat depth = depths({camera.width, camera.height}, CV_16UC1), bgr = smooth(depth.size());
  cv::Mat points, plain, colored;
  const DepthPoints maker(camera);
  maker.points(depth, "16UC1", points);
  maker.cloud(depth, "16UC1", plain);
  maker.cloud(depth, "16UC1", bgr, colored);
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x)
    {
      const auto expected = points.at<cv::Vec3f>(y, x);
      const auto one = plain.at<cv::Vec4f>(y, x), color = colored.at<cv::Vec4f>(y, x);
      for (int i = 0; i < 3; ++i)
      {
        EXPECT_EQ(bits(one[i]), bits(expected[i]));
        EXPECT_EQ(bits(color[i]), bits(expected[i]));
      }
      EXPECT_EQ(one[3], 1.0F);
      const cv::Vec3b pixel = bgr.at<cv::Vec3b>(y, x);
      EXPECT_EQ(bits(color[3]), std::uint32_t{pixel[2]} << 16 | std::uint32_t{pixel[1]} << 8 | pixel[0]);
    }
}

TEST(DepthPoints, aPixelWithoutARayHasNoPoint)
{
  const CameraModel camera{64, 48, {10, 0, 31.5, 0, 10, 23.5, 0, 0, 1}, {0, 0, 0, 0}, "equidistant"};
  ASSERT_TRUE(std::isnan(camera.ray({0.0, 0.0}).x));  // more than 90 degrees from the axis
  cv::Mat points;
  DepthPoints(camera).points(cv::Mat(48, 64, CV_32FC1, cv::Scalar(1.0)), "32FC1", points);
  for (int i = 0; i < 3; ++i)
    EXPECT_TRUE(std::isnan(points.at<cv::Vec3f>(0, 0)[i]));
  EXPECT_EQ(points.at<cv::Vec3f>(24, 32)[2], 1.0F);
}

TEST(DepthPoints, imagesOfAnotherSizeAreRefused)
{
  const DepthPoints maker(depthWorldCamera(64));
  cv::Mat out;
  const cv::Mat small = cv::Mat::zeros(24, 32, CV_16UC1), fits = cv::Mat::zeros(48, 64, CV_16UC1);
  EXPECT_EQ(refusal([&] { maker.points(small, "16UC1", out); }),
            "the size of the depth image is 32x24, must be 64x48 as of its camera");
  EXPECT_EQ(refusal([&] { maker.cloud(fits, "16UC1", cv::Mat::zeros(24, 32, CV_8UC3), out); }),
            "the size of the color image is 32x24, must be 64x48 as of the depth image");
  EXPECT_NE(refusal([&] { maker.cloud(fits, "16UC1", cv::Mat::zeros(48, 64, CV_8UC1), out); }), "");
  EXPECT_NE(refusal([] { DepthPoints{CameraModel()}; }), "");
}
