#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <thread>
#include <tuple>

#include "robot_vision/image/jpeg.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

cv::Mat decoded(const Bytes& bytes, JpegPixels pixels, int reduction = 1)
{
  cv::Mat out;
  decodeJpeg(bytes.data(), bytes.size(), pixels, out, reduction);
  return out;
}

std::string refusalOf(const Bytes& bytes)
{
  return refusal([&] { decoded(bytes, JpegPixels::kBgr); });
}

/// The stream without the segments of `marker`.
Bytes without(unsigned char marker, const Bytes& bytes)
{
  Bytes out(bytes.begin(), bytes.begin() + 2);
  std::size_t i = 2;
  while (bytes[i + 1] != 0xDA)
  {
    const std::size_t end = i + 2 + (bytes[i + 2] << 8 | bytes[i + 3]);
    if (bytes[i + 1] != marker) out.insert(out.end(), bytes.begin() + i, bytes.begin() + end);
    i = end;
  }
  out.insert(out.end(), bytes.begin() + i, bytes.end());
  return out;
}

std::size_t find(const Bytes& bytes, const Bytes& part)
{
  return static_cast<std::size_t>(std::search(bytes.begin(), bytes.end(), part.begin(), part.end()) - bytes.begin());
}

cv::Mat plane(int component)
{
  cv::Mat plane;
  cv::extractChannel(smooth({64, 48}), plane, component);
  return plane;
}

/// A colour JPEG with a scan for each of these components, in this order.
Bytes inScans(const std::vector<int>& components)
{
  const Bytes gray = jpegOf(plane(0));
  const std::size_t frame = find(gray, {0xFF, 0xC0});
  const std::size_t tables = frame + 2 + gray[frame + 3];
  Bytes out(gray.begin(), gray.begin() + frame);
  out.insert(out.end(), {0xFF, 0xC0, 0, 17, 8, 0, 48, 0, 64, 3, 1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0});
  out.insert(out.end(), gray.begin() + tables, gray.begin() + find(gray, {0xFF, 0xDA}));
  for (const int component : components)
  {
    const Bytes jpeg = jpegOf(plane(component));
    out.insert(out.end(), {0xFF, 0xDA, 0, 8, 1, static_cast<std::uint8_t>(component + 1), 0, 0, 63, 0});
    out.insert(out.end(), jpeg.begin() + find(jpeg, {0xFF, 0xDA}) + 10, jpeg.end() - 2);
  }
  out.insert(out.end(), {0xFF, 0xD9});
  return out;
}

}  // namespace

TEST(Jpeg, isDecodedAsOpenCvDoes)
{
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(64, 41), cv::Size(1, 1), cv::Size(37, 19)})
    for (const std::vector<int>& params :
         {std::vector<int>{}, {cv::IMWRITE_JPEG_QUALITY, 30}, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}})
      for (const bool color : {true, false})
      {
        SCOPED_TRACE(testing::Message() << size << ", parameters " << testing::PrintToString(params) << color);
        const Bytes bytes = jpegOf(converted(smooth(size), color ? -1 : cv::COLOR_BGR2GRAY), params);
        const cv::Mat bgr = cv::imdecode(bytes, cv::IMREAD_COLOR);
        EXPECT_TRUE(equal(decoded(bytes, JpegPixels::kBgr), bgr));
        EXPECT_TRUE(equal(decoded(bytes, JpegPixels::kRgb), converted(bgr, cv::COLOR_BGR2RGB)));
        EXPECT_TRUE(equal(decoded(bytes, JpegPixels::kGray), cv::imdecode(bytes, cv::IMREAD_GRAYSCALE)));
        const JpegInfo info = readJpegInfo(bytes.data(), bytes.size());
        EXPECT_EQ(info.size, size);
        EXPECT_EQ(info.color, color);
      }
}

TEST(Jpeg, isDecodedSmaller)
{
  const Bytes bytes = jpegOf(smooth({61, 47}));
  for (const auto& [reduction, flag] :
       {std::pair{2, cv::IMREAD_REDUCED_COLOR_2}, std::pair{4, cv::IMREAD_REDUCED_COLOR_4},
        std::pair{8, cv::IMREAD_REDUCED_COLOR_8}})
  {
    const cv::Mat small = decoded(bytes, JpegPixels::kBgr, reduction);
    EXPECT_EQ(small.size(), cv::Size((61 + reduction - 1) / reduction, (47 + reduction - 1) / reduction));
    EXPECT_TRUE(equal(small, cv::imdecode(bytes, flag))) << reduction;
    EXPECT_EQ(decoded(bytes, JpegPixels::kGray, reduction).size(), small.size());
  }
  EXPECT_EQ(refusal([&] { decoded(bytes, JpegPixels::kBgr, 3); }), "reduction is 3, must be 1, 2, 4 or 8");
}

TEST(Jpeg, isEncodedAsOpenCvDoes)
{
  const cv::Mat padded = noise({50, 30}, CV_8UC4, /*row_padding=*/7);
  const cv::Mat bgr = converted(padded, cv::COLOR_BGRA2BGR), rgb = converted(padded, cv::COLOR_BGRA2RGB),
                rgba = converted(padded, cv::COLOR_BGRA2RGBA), gray = converted(padded, cv::COLOR_BGRA2GRAY);
  for (const JpegParams& params : {JpegParams{}, JpegParams{95, false, false, 0}, JpegParams{50, true, false, 0},
                                   JpegParams{80, false, true, 0}, JpegParams{80, false, false, 3}})
  {
    const std::vector<int> same = {
        cv::IMWRITE_JPEG_QUALITY,  params.quality,          cv::IMWRITE_JPEG_PROGRESSIVE,  params.progressive ? 1 : 0,
        cv::IMWRITE_JPEG_OPTIMIZE, params.optimize ? 1 : 0, cv::IMWRITE_JPEG_RST_INTERVAL, params.restart_interval};
    Bytes bytes;
    for (const auto& [image, is_rgb] : {std::pair{bgr, false}, {rgb, true}, {rgba, true}, {padded, false}})
    {
      const cv::Mat before = image.clone();
      encodeJpeg(image, is_rgb, params, bytes);
      EXPECT_EQ(bytes, jpegOf(bgr, same)) << testing::PrintToString(same) << is_rgb;
      EXPECT_TRUE(equal(image, before));
    }
    encodeJpeg(gray, false, params, bytes);
    EXPECT_EQ(bytes, jpegOf(gray, same));
  }
}

TEST(Jpeg, refusesToEncodeOtherTypesAndSizes)
{
  Bytes out;
  const auto encode = [&](const cv::Mat& image, const JpegParams& params = {})
  { return refusal([&] { encodeJpeg(image, false, params, out); }); };
  EXPECT_EQ(encode(cv::Mat(2, 2, CV_16UC1)),
            "pixels of CV_16UC1 cannot become JPEG, must be CV_8UC1, CV_8UC3 or CV_8UC4");
  EXPECT_EQ(encode(cv::Mat(1, 65501, CV_8UC1)), "an image of 65501x1 cannot become JPEG: it has no or too many pixels");
  EXPECT_EQ(encode(cv::Mat(0, 0, CV_8UC1)), "an image of 0x0 cannot become JPEG: it has no or too many pixels");
  EXPECT_EQ(encode(cv::Mat(2, 2, CV_8UC1), {0, false, false, 0}), "jpeg_quality is 0, must be from 1 to 100");
  EXPECT_EQ(encode(cv::Mat(2, 2, CV_8UC1), {80, false, false, 65536}),
            "jpeg_restart_interval is 65536, must be from 0 to 65535");
}

TEST(Jpeg, isRefusedWhereverItIsCut)
{
  const Bytes bytes = jpegOf(smooth({64, 48}));
  for (std::size_t size = 0; size < bytes.size(); ++size)
  {
    const Bytes cut(bytes.begin(), bytes.begin() + size);
    const std::string refused = "JPEG of " + std::to_string(size) + " bytes ";
    ASSERT_EQ(refusalOf(cut).find(refused + "cannot be decoded: "), 0u) << refusalOf(cut);
    Bytes copy;
    ASSERT_EQ(refusal([&] { copyJpeg(cut.data(), cut.size(), copy); }), refused + "is damaged or truncated");
  }
}

TEST(Jpeg, isRefusedWithDamagedPixels)
{
  Bytes bytes = jpegOf(noise({64, 48}, CV_8UC3));
  const std::size_t middle = bytes.size() / 2;
  bytes.erase(bytes.begin() + middle, bytes.end() - 2);  // keeps the marker at the end
  EXPECT_EQ(refusalOf(bytes).find("JPEG of " + std::to_string(bytes.size()) + " bytes cannot be decoded: "), 0u);
}

TEST(Jpeg, mayBePadded)
{
  const Bytes whole = jpegOf(smooth({64, 48}));
  Bytes padded = whole;
  padded.insert(padded.end() - 2, 40, 0);
  padded.insert(padded.end(), 100, 0);
  EXPECT_TRUE(equal(decoded(padded, JpegPixels::kBgr), decoded(whole, JpegPixels::kBgr)));
}

// A harmless warning must not hide real damage.
TEST(Jpeg, isRefusedIfDamagedAfterExtraBytes)
{
  for (const unsigned char marker : {0xDB, 0xC0, 0xC4, 0xDA})  // tables, frame and scan
  {
    Bytes bytes = jpegOf(noise({64, 48}, CV_8UC3));
    const cv::Mat expected = decoded(bytes, JpegPixels::kBgr);
    bytes.insert(bytes.begin() + find(bytes, {0xFF, marker}), 5, 0x11);
    EXPECT_TRUE(equal(decoded(bytes, JpegPixels::kBgr), expected)) << int{marker};
    Bytes copy;
    EXPECT_EQ(copyJpeg(bytes.data(), bytes.size(), copy).size, cv::Size(64, 48));
    EXPECT_EQ(copy, bytes);
    bytes.erase(bytes.begin() + bytes.size() / 2, bytes.end() - 2);
    EXPECT_NE(refusalOf(bytes).find("premature end of data segment"), std::string::npos) << refusalOf(bytes);
  }
}

TEST(Jpeg, mayHaveAFewBytesBeforeARestartButNotMany)
{
  const Bytes whole = jpegOf(noise({64, 48}, CV_8UC3), {cv::IMWRITE_JPEG_RST_INTERVAL, 2});
  const auto restart = static_cast<std::ptrdiff_t>(find(whole, {0xFF, 0xD1}));
  Bytes few = whole, many = whole;
  few.insert(few.begin() + restart, 10, 0x11);  // some webcams write nearly every image like this
  EXPECT_TRUE(equal(decoded(few, JpegPixels::kBgr), decoded(whole, JpegPixels::kBgr)));
  many.insert(many.begin() + restart, 33, 0x11);  // means that others were lost
  EXPECT_NE(refusalOf(many).find("33 extraneous bytes before marker 0xd1"), std::string::npos) << refusalOf(many);
}

TEST(Jpeg, isRefusedWithBytesInsertedIntoItsScan)
{
  const Bytes whole = jpegOf(noise({64, 48}, CV_8UC3));
  std::mt19937 random(0x5EED);  // NOLINT: the same damage every time
  for (int i = 0; i < 100; ++i)
  {
    Bytes bytes = whole;
    Bytes foreign(4096);
    std::generate(foreign.begin(), foreign.end(), [&random] { return static_cast<std::uint8_t>(random() % 255); });
    bytes.insert(bytes.begin() + bytes.size() / 2, foreign.begin(), foreign.end());
    EXPECT_NE(refusalOf(bytes), "") << i;
  }
}

// Hardware encoders write whole words or whole cache lines, and many webcams zeros.
TEST(Jpeg, mayHaveExtraBytesBeforeItsEnd)
{
  const Bytes whole = jpegOf(smooth({64, 48}));
  for (const Bytes& left : {Bytes(30, 0x11), Bytes(40, 0x00), Bytes(5000, 0x00), Bytes(5000, 0xFF)})
  {
    Bytes bytes = whole;
    bytes.insert(bytes.end() - 2, left.begin(), left.end());
    EXPECT_TRUE(equal(decoded(bytes, JpegPixels::kBgr), decoded(whole, JpegPixels::kBgr))) << int{left[0]};
  }
}

TEST(Jpeg, mayCarryOddSegments)
{
  const Bytes whole = jpegOf(smooth({64, 48}));
  const std::size_t version = find(whole, {'J', 'F', 'I', 'F', 0}) + 5;
  Bytes odd = whole;
  odd[version] = 9;
  const Bytes avi = {0xFF, 0xE0, 0, 8, 'A', 'V', 'I', '1', 0, 0};
  const Bytes adobe = {0xFF, 0xEE, 0, 14, 'A', 'd', 'o', 'b', 'e', 0, 100, 0, 0, 0, 0, 7};  // unknown color space
  for (const Bytes& segment : {avi, adobe})
    odd.insert(odd.begin() + 2, segment.begin(), segment.end());
  EXPECT_TRUE(equal(decoded(odd, JpegPixels::kBgr), decoded(whole, JpegPixels::kBgr)));
}

// The tables of one stream must not be used for the next one.
TEST(Jpeg, isDecodedByItsOwnTables)
{
  const Bytes whole = jpegOf(smooth({64, 48}));
  const Bytes bare = without(0xC4, whole);
  decoded(jpegOf(noise({64, 48}, CV_8UC3), {cv::IMWRITE_JPEG_OPTIMIZE, 1}), JpegPixels::kBgr);
  EXPECT_TRUE(equal(decoded(bare, JpegPixels::kBgr), decoded(whole, JpegPixels::kBgr)));
  EXPECT_NE(refusalOf(without(0xDB, whole)), "");
}

TEST(Jpeg, isRefusedIfScansAreMissing)
{
  const Bytes whole = inScans({0, 1, 2});
  EXPECT_TRUE(equal(decoded(whole, JpegPixels::kGray), decoded(jpegOf(plane(0)), JpegPixels::kGray)));
  const auto missing = [](const Bytes& bytes)
  { return "JPEG of " + std::to_string(bytes.size()) + " bytes is damaged: some of its scans are missing"; };
  for (const Bytes& part : {inScans({0, 1}), inScans({1, 2}), inScans({0})})
    EXPECT_EQ(refusalOf(part), missing(part));

  Bytes rough = jpegOf(smooth({64, 48}), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  EXPECT_EQ(refusalOf(rough), "");
  const std::size_t first = find(rough, {0xFF, 0xDA}) + 2;
  rough.resize(first + find(Bytes(rough.begin() + first, rough.end()), {0xFF, 0xDA}));
  rough.insert(rough.end(), {0xFF, 0xD9});
  EXPECT_EQ(refusalOf(rough), missing(rough));
}

TEST(Jpeg, isRefusedWithTooManyScans)
{
  std::vector<int> scans(100);
  for (std::size_t i = 0; i < scans.size(); ++i)
    scans[i] = static_cast<int>(i % 3);
  EXPECT_EQ(refusalOf(inScans(scans)), "");
  scans.insert(scans.end(), {0, 1, 2});
  const Bytes many = inScans(scans);
  EXPECT_EQ(refusalOf(many),
            "JPEG of " + std::to_string(many.size()) + " bytes cannot be decoded: it has more than 100 scans");
}

TEST(Jpeg, isRefusedIfItClaimsToBeHuge)
{
  Bytes bytes = jpegOf(smooth({64, 48}));
  const std::size_t frame = find(bytes, {0xFF, 0xC0});  // height and width are 5 bytes further
  for (std::size_t i = 5; i < 9; i += 2)
    std::tie(bytes[frame + i], bytes[frame + i + 1]) = std::pair{0xFD, 0xE8};
  EXPECT_EQ(refusalOf(bytes), "JPEG of " + std::to_string(bytes.size()) +
                                  " bytes claims to be of 65000x65000, the most is 67108864 pixels");
}

TEST(Jpeg, isCopiedUntouched)
{
  for (const std::vector<int>& params : {std::vector<int>{}, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}})
  {
    const Bytes bytes = jpegOf(smooth({64, 48}), params);
    Bytes copy;
    copyJpeg(bytes.data(), bytes.size(), copy);
    EXPECT_EQ(copy, bytes);
  }
}

TEST(Jpeg, getsTheHuffmanTablesThatCamerasOmit)
{
  const Bytes whole = jpegOf(smooth({64, 48}));
  const Bytes bare = without(0xC4, whole);
  ASSERT_EQ(find(bare, {0xFF, 0xC4}), bare.size());
  EXPECT_TRUE(equal(decoded(bare, JpegPixels::kBgr), decoded(whole, JpegPixels::kBgr)));
  Bytes copy;
  copyJpeg(bare.data(), bare.size(), copy);
  EXPECT_EQ(copy.size(), whole.size());
  EXPECT_TRUE(equal(cv::imdecode(copy, cv::IMREAD_COLOR), cv::imdecode(whole, cv::IMREAD_COLOR)));
  // T.81, tables K.3 and K.5: the lengths of the codes for luma.
  EXPECT_LT(find(copy, {0x00, 0, 1, 5, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4}), copy.size());
  EXPECT_LT(find(copy, {0x10, 0, 2, 1, 3, 3, 2, 4, 3, 5, 5, 4, 4, 0, 0, 1, 0x7D}), copy.size());
}

TEST(Jpeg, isDecodedInSeveralThreads)
{
  const Bytes bytes = jpegOf(smooth({64, 48}));
  const cv::Mat expected = decoded(bytes, JpegPixels::kBgr);
  std::array<int, 4> wrong{};
  std::vector<std::thread> threads;
  for (int& count : wrong)
    threads.emplace_back(
        [&]
        {
          for (int i = 0; i < 50; ++i)
            count += equal(decoded(bytes, JpegPixels::kBgr), expected) ? 0 : 1;
        });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(wrong, (std::array<int, 4>{}));
}
