#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <tuple>

#include "core/codecs/png.hpp"
#include "robot_vision/codecs/image_file.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr int kFlags[] = {cv::IMREAD_UNCHANGED,
                          cv::IMREAD_COLOR,
                          cv::IMREAD_GRAYSCALE,
                          cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH,
                          cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH,
                          cv::IMREAD_ANYCOLOR | cv::IMREAD_ANYDEPTH};

void putNumber(Bytes& bytes, std::uint32_t number)
{
  for (const int shift : {24, 16, 8, 0})
    bytes.push_back(static_cast<std::uint8_t>(number >> shift));
}

void putChunk(Bytes& bytes, const std::string& name, const Bytes& content)
{
  putNumber(bytes, static_cast<std::uint32_t>(content.size()));
  const auto begin = static_cast<std::ptrdiff_t>(bytes.size());
  bytes.insert(bytes.end(), name.begin(), name.end());
  bytes.insert(bytes.end(), content.begin(), content.end());
  std::uint32_t checksum = 0xFFFFFFFF;  // CRC-32
  for (auto byte = bytes.begin() + begin; byte != bytes.end(); ++byte)
  {
    checksum ^= *byte;
    for (int i = 0; i < 8; ++i)
      checksum = (checksum & 1U) != 0 ? checksum >> 1 ^ 0xEDB88320 : checksum >> 1;
  }
  putNumber(bytes, ~checksum);
}

/// What a PNG has that OpenCV does not write.
struct Png
{
  std::uint8_t width, height, bits, color, interlaced;
  Bytes rows;  // each with its filter in front
  Bytes palette, transparent;
};

Bytes encoded(const Png& png)
{
  std::uint32_t low = 1, high = 0;  // Adler-32
  for (const std::uint8_t byte : png.rows)
  {
    low = (low + byte) % 65521;
    high = (high + low) % 65521;
  }
  const auto size = static_cast<std::uint8_t>(png.rows.size()), inverse = static_cast<std::uint8_t>(~size);
  Bytes pixels = {0x78, 0x01, 1, size, 0, inverse, 0xFF};  // a single block, which is not compressed
  pixels.insert(pixels.end(), png.rows.begin(), png.rows.end());
  putNumber(pixels, high << 16 | low);
  Bytes bytes = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  putChunk(bytes, "IHDR", {0, 0, 0, png.width, 0, 0, 0, png.height, png.bits, png.color, 0, 0, png.interlaced});
  if (!png.palette.empty()) putChunk(bytes, "PLTE", png.palette);
  if (!png.transparent.empty()) putChunk(bytes, "tRNS", png.transparent);
  putChunk(bytes, "IDAT", pixels);
  putChunk(bytes, "IEND", {});
  return bytes;
}

void expectAsOpenCv(const Bytes& bytes, const std::string& what)
{
  for (const int flags : kFlags)
  {
    const cv::Mat expected = cv::imdecode(bytes, flags), found = decodePng(bytes.data(), bytes.size(), flags);
    ASSERT_EQ(found.type(), expected.type()) << what << " " << flags;
    ASSERT_EQ(found.size(), expected.size()) << what << " " << flags;
    EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0.0) << what << " " << flags;
  }
}

}  // namespace

TEST(Png, isDecodedAsOpenCvDoes)
{
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4})
  {
    Bytes bytes;
    encodePng(noise({19, 7}, type), 9, bytes);
    expectAsOpenCv(bytes, cv::typeToString(type));
  }
  const Bytes colors = {10, 20, 30, 200, 100, 50, 0, 255, 0, 90, 80, 70};
  const Bytes gray2 = {0, 0x1B, 0, 0xE4}, gray4 = {0, 0x1F, 0, 0xA0};
  for (const auto& [what, png] : std::initializer_list<std::pair<const char*, Png>>{
           {"1 bit", {8, 2, 1, 0, 0, {0, 0xA5, 0, 0x0F}, {}, {}}},
           {"2 bits", {4, 2, 2, 0, 0, gray2, {}, {}}},
           {"4 bits", {2, 2, 4, 0, 0, gray4, {}, {}}},
           {"4 bits, one transparent", {2, 2, 4, 0, 0, gray4, {}, {0, 10}}},
           {"palette of 2 bits", {4, 2, 2, 3, 0, gray2, colors, {}}},
           {"palette with opacities", {4, 2, 2, 3, 0, gray2, colors, {255, 0, 128}}},
           {"gray and alpha", {2, 1, 8, 4, 0, {0, 10, 255, 200, 7}, {}, {}}},
           {"wide gray and alpha", {1, 1, 16, 4, 0, {0, 1, 2, 3, 4}, {}, {}}},
           {"one color transparent", {2, 1, 8, 2, 0, {0, 1, 2, 3, 9, 8, 7}, {}, {0, 9, 0, 8, 0, 7}}},
           {"interlaced", {2, 2, 8, 0, 1, {0, 10, 0, 60, 0, 110, 210}, {}, {}}},
       })
    expectAsOpenCv(encoded(png), what);
}

TEST(Png, isTurnedAsItsExifSays)
{
  Bytes bytes = encoded({2, 1, 8, 0, 0, {0, 10, 200}, {}, {}});
  Bytes chunk;  // whose only entry is the orientation 6: to be turned clockwise
  putChunk(chunk, "eXIf", {'M', 'M', 0, 42, 0, 0, 0, 8, 0, 1, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, 6, 0, 0, 0, 0, 0, 0});
  const std::string idat = "IDAT";
  bytes.insert(std::search(bytes.begin(), bytes.end(), idat.begin(), idat.end()) - 4, chunk.begin(), chunk.end());
  for (const int flags : kFlags)
  {
    const cv::Mat expected = cv::imdecode(bytes, flags), found = decodeImageFile(bytes.data(), bytes.size(), flags);
    ASSERT_EQ(found.size(), expected.size()) << flags;
    EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0.0) << flags;
  }
}

TEST(Png, isRefusedWithoutOutputIfItIsDamaged)
{
  Png png = {2, 2, 8, 0, 0, {0, 10, 20, 0, 30, 40}, {}, {}};
  const Bytes whole = encoded(png);
  const auto behind = [](Bytes& bytes, const std::string& name)
  { return std::search(bytes.begin(), bytes.end(), name.begin(), name.end()) + 4; };
  Bytes checksum = whole, header = whole, late = whole;
  *(behind(checksum, "IDAT") + 9) ^= 0x40;
  *(behind(header, "IHDR") + 8) = 7;                               // bits
  late.erase(behind(late, "IDAT") - 8, behind(late, "IEND") - 8);  // all of the pixels
  png.rows[3] = 9;  // a filter that there is not, with the right checksums
  const Bytes filter = encoded(png);
  png.rows = {0, 10, 20};
  const Bytes few = encoded(png);
  testing::internal::CaptureStderr();
  for (const Bytes& bytes : {checksum, header, late, filter, few})
  {
    const std::string refused = "PNG of " + std::to_string(bytes.size()) + " bytes cannot be decoded: ";
    for (const int flags : {static_cast<int>(cv::IMREAD_COLOR), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION})
    {
      const std::string reason = refusal([&] { decodeImageFile(bytes.data(), bytes.size(), flags); });
      EXPECT_EQ(reason.find(refused), 0u) << reason;
      EXPECT_GT(reason.size(), refused.size());
    }
    EXPECT_EQ(refusal([&] { decodePng(bytes.data(), bytes.size(), cv::IMREAD_UNCHANGED); }).find(refused), 0u);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

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
