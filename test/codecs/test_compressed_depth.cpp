#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "robot_vision/codecs/compressed_depth.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

CompressedImage compressed(const cv::Mat& image, const std::string& encoding, const DepthCompressionParams& params = {})
{
  CompressedImage coded;
  compressDepth(image, encoding, params, coded);
  return coded;
}

cv::Mat decompressed(const CompressedImage& from)
{
  cv::Mat image;
  EXPECT_EQ(decompressDepth(from.format, from.data.data(), from.data.size(), image),
            from.format.substr(0, from.format.find(';')));
  return image;
}

template <class T>
T at(const CompressedImage& coded, std::size_t offset)
{
  T value;
  std::memcpy(&value, coded.data.data() + offset, sizeof(value));
  return value;
}

cv::Mat pngOf(const CompressedImage& coded)
{
  return cv::imdecode(std::vector<std::uint8_t>(coded.data.begin() + 12, coded.data.end()), cv::IMREAD_UNCHANGED);
}

}  // namespace

TEST(CompressedDepth, isLosslessUpToDepthMaxForMillimetres)
{
  const cv::Mat image = noise({31, 17}, CV_16UC1, /*row_padding=*/5);
  const cv::Mat before = image.clone();
  cv::Mat expected = image.clone();
  expected.setTo(0, image > 10000);
  for (const std::string encoding : {"16UC1", "mono16"})
  {
    const CompressedImage coded = compressed(image, encoding);
    EXPECT_EQ(coded.format, encoding + "; compressedDepth png");
    EXPECT_EQ(at<std::int32_t>(coded, 0), 0);
    EXPECT_TRUE(equal(pngOf(coded), expected));
    EXPECT_TRUE(equal(decompressed(coded), expected));
  }
  EXPECT_TRUE(equal(image, before));
  DepthCompressionParams far;
  far.depth_max = 100.0;
  for (const char* format : {"png", "rvl"})
  {
    far.format = format;
    EXPECT_TRUE(equal(decompressed(compressed(image, "16UC1", far)), image)) << format;
  }
}

TEST(CompressedDepth, isTheInverseDepthForMetres)
{
  const float none = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat_<float> image =
      (cv::Mat_<float>(1, 10) << 0.2F, 0.5F, 1.0F, 3.0F, 9.9F, 10.0F, none, 0.0F, -1.0F, 0.01F);
  const CompressedImage coded = compressed(image, "32FC1");
  EXPECT_EQ(coded.format, "32FC1; compressedDepth png");
  EXPECT_FLOAT_EQ(at<float>(coded, 4), 100.0F * 101.0F);
  EXPECT_FLOAT_EQ(at<float>(coded, 8), 1.0F - 10100.0F / 10.0F);
  const cv::Mat codes = pngOf(coded);
  ASSERT_EQ(codes.type(), CV_16UC1);
  EXPECT_EQ(codes.at<std::uint16_t>(0, 2), 10100 - 1009);
  EXPECT_EQ(codes.at<std::uint16_t>(0, 6), 0);

  const cv::Mat back = decompressed(coded);
  ASSERT_EQ(back.type(), CV_32FC1);
  for (int i = 0; i < 5; ++i)
  {
    const float z = image(0, i);
    EXPECT_NEAR(back.at<float>(0, i), z, z * z / 10100.0F * 1.01F + 1e-6F);  // one step of the code
  }
  for (const int i : {5, 6, 7, 8})
    EXPECT_TRUE(std::isnan(back.at<float>(0, i))) << i;
  EXPECT_NEAR(back.at<float>(0, 9), 10100.0F / (65535.0F + 1009.0F), 1e-4F);  // the nearest depth that has a code
}

TEST(CompressedDepth, isReadWithAnOlderLabel)
{
  const cv::Mat image = noise({8, 8}, CV_16UC1) / 10;
  CompressedImage coded = compressed(image, "16UC1");
  for (const char* format : {"16UC1; compressedDepth", "16UC1"})
  {
    coded.format = format;
    EXPECT_TRUE(equal(decompressed(coded), image));
  }
}

TEST(CompressedDepth, isRefusedIfDamaged)
{
  const CompressedImage good = compressed(noise({8, 8}, CV_16UC1), "16UC1");
  const auto refused = [](const std::string& format, const std::vector<std::uint8_t>& data)
  {
    cv::Mat image;
    return refusal([&] { decompressDepth(format, data.data(), data.size(), image); });
  };
  EXPECT_EQ(refused(good.format, {1, 2, 3}), "compressed depth of 3 bytes has no whole header");
  EXPECT_EQ(refused(good.format, std::vector<std::uint8_t>(30)), "PNG of 18 bytes does not begin as a PNG");
  EXPECT_EQ(refused("16UC1; compressedDepth lz4", good.data),
            "format is '16UC1; compressedDepth lz4', must be 16UC1, mono16 or 32FC1 with '; compressedDepth png' or "
            "'; compressedDepth rvl'");
  EXPECT_NE(refused("16UC1; compressedDepth rvl", good.data).find("claims to be of 1196314761x169478669, the most"),
            std::string::npos);  // the first bytes of a PNG
  EXPECT_EQ(refused("bgr8; jpeg compressed bgr8", good.data).find("format is 'bgr8; jpeg"), 0u);
  std::vector<std::uint8_t> png;
  cv::imencode(".png", cv::Mat(2, 2, CV_8UC1, cv::Scalar(7)), png);
  std::vector<std::uint8_t> narrow(12);
  narrow.insert(narrow.end(), png.begin(), png.end());
  EXPECT_EQ(refused(good.format, narrow),
            "compressed depth: expected a PNG of 1 x 16 bits (CV_16UC1), got 1 x 8 bits (CV_8UC1)");
  std::vector<std::uint8_t> huge = good.data;
  huge[12 + 16] = 0x7F;  // the highest byte of the width
  EXPECT_NE(refused(good.format, huge).find("claims to be of 2130706440x8, the most is 67108864 pixels"),
            std::string::npos);
}

TEST(CompressedDepth, refusesToCompressOtherEncodingsAndTypes)
{
  EXPECT_TRUE(isDepth("32FC1"));
  EXPECT_FALSE(isDepth("bgr8"));
  EXPECT_EQ(refusal([] { compressed(cv::Mat(2, 2, CV_8UC3), "bgr8"); }),
            "encoding is 'bgr8', must be 16UC1, mono16 or 32FC1");
  EXPECT_EQ(refusal([] { compressed(cv::Mat(2, 2, CV_16UC1), "32FC1"); }),
            "32FC1 image of 2x2: expected pixels of 1 x 32 bits (CV_32FC1), got 1 x 16 bits (CV_16UC1)");
  for (const auto& [params, reason] : {std::pair{DepthCompressionParams{"png", 0.5, 100.0, 1}, "depth_max is 0.5"},
                                       {DepthCompressionParams{"png", 10.0, 151.0, 1}, "depth_quantization is 151"},
                                       {DepthCompressionParams{"rvl", 10.0, 100.0, 0}, "png_level is 0"},
                                       {DepthCompressionParams{"jpeg", 10.0, 100.0, 1}, "format is 'jpeg', must be"}})
    EXPECT_EQ(refusal([&, &params = params] { validate(params); }).find(reason), 0u);
}
