#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "core/codecs/image_header.hpp"
#include "robot_vision/codecs/image_file.hpp"
#include "robot_vision/common/printable.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

// The width is even, because OpenCV reads beyond odd rows of the Sun raster that it writes.
const cv::Size kSize{18, 7};

Bytes encoded(const std::string& suffix, const cv::Mat& image = noise(kSize, CV_8UC3))
{
  Bytes bytes;
  EXPECT_TRUE(cv::imencode(suffix, image, bytes)) << suffix;
  return bytes;
}

Bytes bytesOf(const std::string& text)
{
  return {text.begin(), text.end()};
}

/// Writes a number of `count` bytes into a file.
void put(Bytes& file, std::size_t at, std::uint64_t value, std::size_t count, bool big_endian)
{
  for (std::size_t i = 0; i < count; ++i)
    file[at + (big_endian ? count - 1 - i : i)] = static_cast<std::uint8_t>(value >> 8 * i);
}

/// Small files whose headers claim sizes that would fill the memory.
std::vector<std::pair<std::string, Bytes>> bombs()
{
  constexpr std::uint64_t kSide = 30000;
  Bytes png = encoded(".png"), jpeg = encoded(".jpg"), bmp = encoded(".bmp"), webp = encoded(".webp"),
        sun = encoded(".ras"), tiff = encoded(".tiff");
  put(png, 16, kSide, 4, true);
  put(png, 20, kSide, 4, true);
  const Bytes frame = {0xFF, 0xC0};
  const auto at =
      static_cast<std::size_t>(std::search(jpeg.begin(), jpeg.end(), frame.begin(), frame.end()) - jpeg.begin());
  put(jpeg, at + 5, kSide, 2, true);
  put(jpeg, at + 7, kSide, 2, true);
  put(bmp, 18, kSide, 4, false);
  put(bmp, 22, static_cast<std::uint64_t>(-static_cast<std::int64_t>(kSide)), 4, false);
  put(webp, 21, 16382 | 16382 << 14, 4, false);  // OpenCV writes lossless WebP by default
  Bytes lossy;
  cv::imencode(".webp", noise(kSize, CV_8UC3), lossy, {cv::IMWRITE_WEBP_QUALITY, 80});
  put(lossy, 26, 16383, 2, false);
  put(lossy, 28, 16383, 2, false);
  put(sun, 4, kSide, 4, true);
  put(sun, 8, kSide, 4, true);
  std::size_t entry = tiff[4] | tiff[5] << 8 | tiff[6] << 16 | tiff[7] << 24;
  const std::size_t entries = tiff[entry] | tiff[entry + 1] << 8;
  entry += 2;
  for (std::size_t i = 0; i < entries; ++i, entry += 12)
  {
    if (tiff[entry + 1] != 1 || tiff[entry] > 1) continue;  // tags 256 and 257
    put(tiff, entry + 2, 4, 2, false);
    put(tiff, entry + 8, kSide, 4, false);
  }
  return {{"png", png},
          {"jpeg", jpeg},
          {"bmp", bmp},
          {"webp", webp},
          {"lossy webp", lossy},
          {"sun raster", sun},
          {"tiff", tiff},
          {"pgm", bytesOf("P5 # 1 1\n30000\n# 2\n30000 255\n")},
          {"pam", bytesOf("P7\nWIDTH 30000\nHEIGHT 30000\nDEPTH 3\nMAXVAL 255\nTUPLTYPE RGB\nENDHDR\n")},
          {"pfm", bytesOf("PF\n30000 30000\n-1.0\n")},
          {"overflow", bytesOf("P5 99999999999999999999999999 99999999999999999999999999 255\n")}};
}

}  // namespace

TEST(ImageFile, isDecodedAsOpenCvDoes)
{
  for (const char* suffix : {".png", ".jpg", ".bmp", ".ppm", ".webp", ".tiff", ".ras", ".pam"})
  {
    const Bytes file = encoded(suffix);
    const auto claimed = claimedSize(file.data(), file.size());
    ASSERT_TRUE(claimed) << suffix;
    EXPECT_EQ(claimed->width, 18u) << suffix;
    EXPECT_EQ(claimed->height, 7u) << suffix;
    const cv::Mat image = decodeImageFile(file.data(), file.size(), cv::IMREAD_COLOR);
    ASSERT_EQ(image.size(), kSize) << suffix;
    EXPECT_EQ(cv::norm(image, cv::imdecode(file, cv::IMREAD_COLOR), cv::NORM_INF), 0.0) << suffix;
  }
  const Bytes wide = encoded(".png", noise(kSize, CV_16UC1));
  EXPECT_EQ(decodeImageFile(wide.data(), wide.size(), cv::IMREAD_UNCHANGED).type(), CV_16UC1);
}

TEST(ImageFile, isRefusedIfItClaimsASizeThatWouldFillTheMemory)
{
  for (const auto& [name, file] : bombs())
  {
    const std::string reason =
        refusal([&, &bytes = file] { decodeImageFile(bytes.data(), bytes.size(), cv::IMREAD_COLOR); });
    EXPECT_EQ(reason.find("claims to be of "), 0u) << name << ": " << reason;
    EXPECT_NE(reason.find(", the most is 67108864 pixels"), std::string::npos) << name;
  }
}

TEST(ImageFile, isNotDecodedIfItHidesItsSize)
{
  const auto decoded = [](const Bytes& file) { return decodeImageFile(file.data(), file.size(), cv::IMREAD_COLOR); };
  Bytes png = encoded(".png");
  const Bytes text = {0, 0, 0, 8, 't', 'E', 'X', 't', 0, 0, 0, 1, 0, 0, 0, 1, 0xE2, 0x0E, 0x33, 0x84};
  png.insert(png.begin() + 8, text.begin(), text.end());
  EXPECT_TRUE(decoded(png).empty());
  EXPECT_TRUE(decoded(bytesOf("P5\n2#2 1\n1\n255\n" + std::string(100, 'a'))).empty());
  EXPECT_TRUE(decoded(bytesOf("PF\n2#2 3\n1\n-1.0\n" + std::string(100, 'a'))).empty());
}

TEST(ImageFile, mayHaveMarkersAndCommentsThatAreRare)
{
  Bytes jpeg = encoded(".jpg"), pam = encoded(".pam");
  const Bytes temporary = {0xFF, 0x01}, comment = bytesOf("# ENDHDR\n");
  jpeg.insert(jpeg.begin() + 2, temporary.begin(), temporary.end());
  pam.insert(pam.begin() + 3, comment.begin(), comment.end());
  for (const Bytes& file : {jpeg, pam})
    EXPECT_EQ(decodeImageFile(file.data(), file.size(), cv::IMREAD_COLOR).size(), kSize);
}

TEST(ImageFile, isRefusedWithoutOutputIfItIsADamagedJpeg)
{
  const Bytes whole = encoded(".jpg", noise({64, 48}, CV_8UC3));
  Bytes gap = whole, damaged = whole;
  const Bytes rubbish(200, 0x55), marker = {0xFF, 0xD2};
  gap.insert(gap.end() - 2, rubbish.begin(), rubbish.end());
  std::copy(marker.begin(), marker.end(), damaged.begin() + static_cast<std::ptrdiff_t>(damaged.size() / 2));
  const Bytes half(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(whole.size() / 2));
  testing::internal::CaptureStderr();
  for (const Bytes& file : {gap, damaged, half})
  {
    const std::string reason = refusal([&file = file] { decodeImageFile(file.data(), file.size(), cv::IMREAD_COLOR); });
    EXPECT_EQ(reason.find("JPEG of " + std::to_string(file.size()) + " bytes cannot be decoded: "), 0u) << reason;
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ImageFile, givesAnEmptyImageForOtherAndTruncatedFiles)
{
  for (const std::string& text : {"", "P", "P5", "P5 3", "P7", "BM", "II*", "RIFF", "no image", "\x89PNG"})
  {
    const Bytes file = bytesOf(text);
    EXPECT_TRUE(decodeImageFile(file.data(), file.size(), cv::IMREAD_COLOR).empty()) << text;
  }
  std::string pam = "P7\n";  // of which a search for each of its words would never end
  for (int i = 0; i < 2000000; ++i)
    pam += "WIDTH#";
  const Bytes endless = bytesOf(pam);
  EXPECT_TRUE(decodeImageFile(endless.data(), endless.size(), cv::IMREAD_COLOR).empty());
  for (const auto& [name, bomb] : bombs())
    for (std::size_t size = 0; size < std::min<std::size_t>(bomb.size(), 200); ++size)
      refusal([&, &bytes = bomb, size]
              { decodeImageFile(Bytes(bytes.begin(), bytes.begin() + size).data(), size, 1); });
}

TEST(Printable, isOneLineWithoutControlCharacters)
{
  EXPECT_EQ(printable("bgr8; jpeg"), "bgr8; jpeg");
  EXPECT_EQ(printable("a\n\x1b[2J\x9b\xc2\x9b"), "a\\x0a\\x1b[2J\\x9b\\xc2\\x9b");
  EXPECT_EQ(printable(std::string("\0", 1)), "\\x00");
  EXPECT_EQ(printable(std::string(100, 'a')), std::string(100, 'a'));
  EXPECT_EQ(printable(std::string(1000000, 'a')), std::string(97, 'a') + "...");
  EXPECT_EQ(printable(std::string(1000000, '\n')).size(), 100u);
  EXPECT_EQ(printable("abcdef", 5), "ab...");
}

TEST(Shortened, endsWithAWholeCharacter)
{
  EXPECT_EQ(shortened("caf\xc3\xa9", 5), "caf\xc3\xa9");
  EXPECT_EQ(shortened("caf\xc3\xa9s", 5), "caf\xc3\xa9...");
  EXPECT_EQ(shortened("caf\xc3\xa9s", 4), "caf...");
  EXPECT_EQ(shortened("\xbf\xbf\xbf", 2), "...");
  EXPECT_EQ(shortened(std::string(1000000, 'a')), std::string(200, 'a') + "...");
}

TEST(Shortened, keepsCharactersAndEscapesControlCharacters)
{
  for (const std::string characters : {" ~", "\xc2\xa0", "\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x99\x82"})
    EXPECT_EQ(shortened(characters), characters);
  EXPECT_EQ(shortened("a\n\x1b[2J\x7f"), "a\\x0a\\x1b[2J\\x7f");
  EXPECT_EQ(shortened("\xc2\x9b"), "\\xc2\\x9b");           // a control character of Latin-1
  EXPECT_EQ(shortened("\xe2\x80\xae"), "\\xe2\\x80\\xae");  // changes the direction to right-to-left
  EXPECT_EQ(shortened("\xe2\x80\xa8"), "\\xe2\\x80\\xa8");  // the line separator
  EXPECT_EQ(shortened("\xc0\x8a\xff"), "\\xc0\\x8a\\xff");  // an overlong form of \n, and an invalid byte
  EXPECT_EQ(shortened("\xe2\x82"), "\\xe2\\x82");           // ends in the middle of a character
  EXPECT_EQ(shortened(std::string("\0", 1)), "\\x00");
  EXPECT_EQ(shortened(std::string(3, '\n'), 8), "\\x0a\\x0a...");
}

TEST(LogLine, keepsItsBeginningAndItsEnd)
{
  EXPECT_EQ(logLine("caf\xc3\xa9\n"), "caf\xc3\xa9\\x0a");
  EXPECT_EQ(logLine(std::string(900, 'a')), std::string(900, 'a'));
  EXPECT_EQ(logLine(std::string(1000000, 'a') + ": why"),
            std::string(600, 'a') + "..." + std::string(295, 'a') + ": why");
  std::string characters;
  for (int i = 0; i < 1000; ++i)
    characters += "\xe2\x82\xac";
  EXPECT_EQ(logLine(characters + "s"), characters.substr(0, 600) + "..." + characters.substr(0, 297) + "s");
}
