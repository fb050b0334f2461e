#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "core/codecs/rvl.hpp"
#include "robot_vision/codecs/compressed_depth.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

Bytes encoded(const cv::Mat& image)
{
  Bytes out;
  encodeRvl(image, out);
  return out;
}

/// A stream of these words, of which the first two are width and height.
Bytes streamOf(const std::vector<std::uint32_t>& words)
{
  Bytes bytes(words.size() * sizeof(words[0]));
  std::memcpy(bytes.data(), words.data(), bytes.size());
  return bytes;
}

std::string refused(const Bytes& bytes)
{
  return refusal([&] { decodeRvl(bytes.data(), bytes.size()); });
}

cv::Mat decoded(const Bytes& bytes)
{
  return decodeRvl(bytes.data(), bytes.size());
}

}  // namespace

TEST(Rvl, isWhatThePaperSays)
{
  // Runs of 2 holes and 3 depths, whose differences 1000, 1 and -2 are folded to 2000, 2 and 3; then 1 hole and
  // nothing.
  const cv::Mat image = (cv::Mat_<std::uint16_t>(2, 3) << 0, 0, 1000, 1001, 999, 0);
  // 2000 is 3720 in groups of 3 bits: 0, 2, 7, 3 from the lowest, of which all but the last say that more follow.
  const Bytes expected = streamOf({3, 2, 0x238AF323, 0x10000000});
  EXPECT_EQ(encoded(image), expected);
  EXPECT_TRUE(equal(decoded(expected), image));
}

TEST(Rvl, losesNothing)
{
  const cv::Mat noisy = noise({31, 17}, CV_16UC1, /*row_padding=*/5);
  cv::Mat holes = noisy.clone();
  holes.setTo(0, noisy < 20000);
  cv::Mat extremes(3, 5, CV_16UC1, cv::Scalar(65535));
  extremes.col(1).setTo(0);
  extremes.col(2).setTo(1);
  for (const cv::Mat& image : {noisy, holes, extremes, cv::Mat(cv::Mat::zeros(4, 6, CV_16UC1)),
                               cv::Mat(1, 1, CV_16UC1, cv::Scalar(0)), cv::Mat(1, 1, CV_16UC1, cv::Scalar(7))})
  {
    const cv::Mat before = image.clone();
    EXPECT_TRUE(equal(decoded(encoded(image)), image)) << image.size();
    EXPECT_TRUE(equal(image, before));
  }
}

TEST(Rvl, hasDepthsOfMetresByTheirInverse)
{
  DepthCompressionParams params;
  const cv::Mat_<float> image = (cv::Mat_<float>(1, 4) << 0.5F, 3.0F, 9.9F, 0.0F);
  CompressedImage png, rvl;
  compressDepth(image, "32FC1", params, png);
  params.format = "rvl";
  compressDepth(image, "32FC1", params, rvl);
  EXPECT_EQ(rvl.format, "32FC1; compressedDepth rvl");
  cv::Mat of_png, of_rvl;
  decompressDepth(png.format, png.data.data(), png.data.size(), of_png);
  EXPECT_EQ(decompressDepth(rvl.format, rvl.data.data(), rvl.data.size(), of_rvl), "32FC1");
  ASSERT_EQ(of_rvl.size(), of_png.size());
  EXPECT_EQ(std::memcmp(of_rvl.data, of_png.data, of_png.total() * of_png.elemSize()), 0);  // NaN, too
}

TEST(Rvl, isRefusedIfDamaged)
{
  EXPECT_EQ(refused({1, 2, 3}), "RVL of 3 bytes has no whole header");
  EXPECT_EQ(refused(streamOf({0, 4})), "RVL of 8 bytes has no pixels");
  EXPECT_EQ(refused(streamOf({65536, 65536, 0})),
            "RVL of 12 bytes claims to be of 65536x65536, the most is 67108864 pixels");
  EXPECT_EQ(refused(streamOf({3, 2, 0x238AF323})), "RVL of 12 bytes is truncated");
  EXPECT_EQ(refused(streamOf({1, 1, 0x20000000})), "RVL of 12 bytes is damaged");              // 2 holes in 1 pixel
  EXPECT_EQ(refused(streamOf({1, 1, 0x01100000})), "RVL of 12 bytes is damaged");              // a depth of -1
  EXPECT_EQ(refused(streamOf({1, 1, 0xFFFFFFFF, 0xFFFFFFFF})), "RVL of 16 bytes is damaged");  // a number without end
}
