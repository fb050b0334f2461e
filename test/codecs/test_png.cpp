#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <tuple>

#include "core/codecs/png.hpp"
#include "robot_vision/codecs/image_file.hpp"
#include "support/images.hpp"

using namespace robot_vision;

TEST(Png, isDecodedWithoutMetadata)
{
  const cv::Mat image = noise({5, 3}, CV_8UC3);
  std::vector<std::uint8_t> bytes;
  encodePng(image, 1, bytes);
  const std::vector<std::uint8_t> plain = bytes;
  const std::string profile("\0\0\0\4iCCPabcd0000", 16);  // a color profile that cannot be read, with a wrong checksum
  constexpr std::size_t kBehindHeader = 8 + 12 + 13;
  bytes.insert(bytes.begin() + kBehindHeader, profile.begin(), profile.end());
  EXPECT_EQ(withoutMetadata(bytes.data(), bytes.size()), plain);
  testing::internal::CaptureStderr();
  EXPECT_EQ(cv::norm(decodePng(bytes.data(), bytes.size(), cv::IMREAD_COLOR), image, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(decodeImageFile(bytes.data(), bytes.size(), cv::IMREAD_COLOR), image, cv::NORM_INF), 0.0);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// The pixels are not read for that: they are decoded only once, when the kind is known.
TEST(Png, tellsItsKindInItsHeader)
{
  for (const auto& [type, color, wide] : {std::tuple{CV_8UC1, false, false},
                                          {CV_8UC3, true, false},
                                          {CV_8UC4, true, false},
                                          {CV_16UC1, false, true},
                                          {CV_16UC3, true, true}})
  {
    std::vector<std::uint8_t> bytes;
    encodePng(noise({5, 3}, type), 1, bytes);
    const std::vector<std::uint8_t> name = {'I', 'D', 'A', 'T'};
    const auto pixels = std::search(bytes.begin(), bytes.end(), name.begin(), name.end()) + 4;
    *pixels ^= 0xFF;
    const PngInfo info = readPngInfo(bytes.data(), bytes.size());
    EXPECT_EQ(std::tie(info.color, info.wide), std::tie(color, wide)) << cv::typeToString(type);
  }
}
