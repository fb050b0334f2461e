#include "robot_vision/depth/depth_image.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Every number of 16 bits, in rows that are followed by others.
cv::Mat allMillimetres()
{
  cv::Mat padded(258, 256, CV_16UC1, cv::Scalar(7));
  cv::Mat image = padded.colRange(0, 255);
  for (int i = 0; i < 65536; ++i)
    image.at<std::uint16_t>(i / image.cols, i % image.cols) = static_cast<std::uint16_t>(i);
  return image;
}

cv::Mat rowOfFloats(const std::vector<float>& values)
{
  return cv::Mat(values, true).reshape(1, 1);
}

}  // namespace

TEST(DepthImage, millimetresBecomeMetresAndZeroNone)
{
  const cv::Mat image = allMillimetres(), before = image.clone();
  cv::Mat metres, back;
  for (const char* encoding : {"16UC1", "mono16"})
  {
    toMetres(image, encoding, metres);
    ASSERT_EQ(metres.type(), CV_32FC1);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x)
      {
        const int mm = image.at<std::uint16_t>(y, x);
        const float z = metres.at<float>(y, x);
        ASSERT_TRUE(mm == 0 ? std::isnan(z) : z == static_cast<float>(mm) / 1000.0F) << mm << " " << z;
      }
    toMillimetres(metres, "32FC1", back);
    EXPECT_TRUE(equal(back, image));
  }
  EXPECT_TRUE(equal(image, before));
}

TEST(DepthImage, whatIsNoDepthIsNone)
{
  const std::vector<float> values = {kNan, -kNan, kInfinity, -kInfinity, 0.0F, -0.0F, -1.5F, -1e-40F};
  const std::vector<float> depths = {1e-40F, 0.001F, 0.5F, 3.0F, 1e30F, 65.5F, 7.0F, 0.1F};
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    std::vector<float> mixed(37, depths[i]);  // more than a vector has
    for (std::size_t k = i; k < mixed.size(); k += 3)
      mixed[k] = values[i];
    const cv::Mat image = rowOfFloats(mixed);
    cv::Mat metres, millimetres;
    toMetres(image, "32FC1", metres);
    toMillimetres(image, "32FC1", millimetres);
    for (int x = 0; x < image.cols; ++x)
    {
      const bool none = x >= static_cast<int>(i) && (x - static_cast<int>(i)) % 3 == 0;
      const float z = metres.at<float>(x);
      EXPECT_TRUE(none ? std::isnan(z) : z == depths[i]) << values[i] << " " << depths[i] << " " << x;
      EXPECT_TRUE(!none || millimetres.at<std::uint16_t>(x) == 0) << values[i];
    }
  }
}

TEST(DepthImage, itCanBeConvertedInPlace)
{
  cv::Mat image = rowOfFloats({-1.0F, 2.0F, kInfinity});
  const auto* const pixels = image.data;
  toMetres(image, "32FC1", image);
  EXPECT_EQ(image.data, pixels);
  EXPECT_TRUE(std::isnan(image.at<float>(0)) && image.at<float>(1) == 2.0F && std::isnan(image.at<float>(2)));
  cv::Mat deep(1, 1, CV_16UC1, cv::Scalar(1500));
  toMetres(deep, "16UC1", deep);
  EXPECT_EQ(deep.at<float>(0), 1.5F);
}

TEST(DepthImage, millimetresAreRounded)
{
  const cv::Mat metres = rowOfFloats({0.0004F, 0.0006F, 1.2344F, 1.2346F, 65.535F, 65.5354F, 65.536F, 70.0F, 1e30F});
  const std::vector<int> expected = {0, 1, 1234, 1235, 65535, 65535, 0, 0, 0};
  cv::Mat millimetres;
  toMillimetres(metres, "32FC1", millimetres);
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(millimetres.at<std::uint16_t>(static_cast<int>(i)), expected[i]) << metres.at<float>(static_cast<int>(i));
}

TEST(DepthImage, whatIsNoDepthImageIsRefused)
{
  cv::Mat out;
  EXPECT_EQ(refusal([&] { toMetres(cv::Mat::zeros(3, 4, CV_8UC3), "bgr8", out); }),
            "the encoding of a depth image is 'bgr8', must be 16UC1 (mm) or 32FC1 (m)");
  const std::string type = refusal([&] { toMetres(cv::Mat::zeros(3, 4, CV_8UC1), "16UC1", out); });
  EXPECT_NE(type.find("16UC1"), std::string::npos) << type;
  EXPECT_NE(type.find("CV_16UC1"), std::string::npos) << type;
  EXPECT_NE(refusal([&] { toMillimetres(cv::Mat(), "32FC1", out); }).find("empty"), std::string::npos);
  EXPECT_EQ(refusal(
                [&] {
                  checkDepth(cv::Mat::zeros(3, 4, CV_16UC1), "16UC1", {640, 480});
                }),
            "the size of the depth image is 4x3, must be 640x480 as of its camera");
}

TEST(DepthImage, anotherUnitThanThatOfTheEncodingIsTold)
{
  const cv::Size size(64, 48);
  const auto odd = [&size](const char* encoding, double value)
  { return oddDepth(cv::Mat(size, depthType(encoding), cv::Scalar(value)), encoding); };
  EXPECT_EQ(odd("16UC1", 1500), "");
  EXPECT_EQ(odd("32FC1", 1.5), "");
  EXPECT_EQ(odd("32FC1", 1500),
            "the median depth is 1500 m by the encoding 32FC1, expected 0.05 to 200 m: are the numbers in m?");
  EXPECT_EQ(odd("16UC1", 3),
            "the median depth is 3 mm by the encoding 16UC1, expected 0.05 to 30 m: are the numbers in mm?");
  EXPECT_NE(odd("mono16", 45000), "");
  for (const char* encoding : {"16UC1", "32FC1"})
    EXPECT_EQ(odd(encoding, 0), "none of the 64x48 pixels has a depth");
  EXPECT_EQ(odd("32FC1", kNan), "none of the 64x48 pixels has a depth");
  cv::Mat one = cv::Mat::zeros(size, CV_16UC1);
  one.at<std::uint16_t>(11, 13) = 800;
  EXPECT_EQ(oddDepth(one, "16UC1"), "");
}
