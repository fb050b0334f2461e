#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "robot_vision/codecs/compressed_image.hpp"
#include "robot_vision/image/encoding.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

struct Case
{
  std::string encoding;
  int type;
  std::string png_format;
  std::string jpeg_format;
  int stored;  // the code of cv::cvtColor that converts to the stored pixels, -1: none
};

const std::vector<Case> kCases = {
    {"bgr8", CV_8UC3, "bgr8; png compressed bgr8", "bgr8; jpeg compressed bgr8", -1},
    {"rgb8", CV_8UC3, "rgb8; png compressed bgr8", "rgb8; jpeg compressed bgr8", cv::COLOR_RGB2BGR},
    {"bgra8", CV_8UC4, "bgra8; png compressed bgr8", "bgra8; jpeg compressed bgr8", cv::COLOR_BGRA2BGR},
    {"rgba8", CV_8UC4, "rgba8; png compressed bgr8", "rgba8; jpeg compressed bgr8", cv::COLOR_RGBA2BGR},
    {"mono8", CV_8UC1, "mono8; png compressed ", "mono8; jpeg compressed ", -1},
    {"8UC1", CV_8UC1, "8UC1; png compressed ", "8UC1; jpeg compressed ", -1},
    {"8UC3", CV_8UC3, "8UC3; png compressed ", "8UC3; jpeg compressed ", -1},
    {"bayer_grbg8", CV_8UC1, "bayer_grbg8; png compressed ", "bayer_grbg8; jpeg compressed ", -1},
    {"bgr16", CV_16UC3, "bgr16; png compressed bgr16", "bgr8; jpeg compressed bgr8", -1},
    {"rgb16", CV_16UC3, "rgb16; png compressed bgr16", "rgb8; jpeg compressed bgr8", cv::COLOR_RGB2BGR},
    {"rgba16", CV_16UC4, "rgba16; png compressed bgr16", "rgba8; jpeg compressed bgr8", cv::COLOR_RGBA2BGR},
    {"mono16", CV_16UC1, "mono16; png compressed ", "mono8; jpeg compressed ", -1},
    {"16UC1", CV_16UC1, "16UC1; png compressed ", "8UC1; jpeg compressed ", -1},
    {"bayer_rggb16", CV_16UC1, "bayer_rggb16; png compressed ", "bayer_rggb8; jpeg compressed ", -1},
};

CompressedImage compressed(const cv::Mat& image, const std::string& encoding, const std::string& format)
{
  CompressionParams params;
  params.format = format;
  params.jpeg.quality = 90;
  CompressedImage coded;
  compress(image, encoding, params, coded);
  return coded;
}

struct Decompressed
{
  std::string encoding;
  cv::Mat image;
};

Decompressed decompressed(const CompressedImage& from, ColorMode mode = ColorMode::kUnchanged, int reduction = 1)
{
  Decompressed to;
  to.encoding = decompress(from.format, from.data.data(), from.data.size(), mode, reduction, to.image);
  return to;
}

/// The image with the alpha that it has after decompression, which does not know the alpha.
cv::Mat opaque(const cv::Mat& image)
{
  return image.channels() != 4 ? image : converted(converted(image, cv::COLOR_BGRA2BGR), cv::COLOR_BGR2BGRA);
}

}  // namespace

TEST(CompressedImage, isLosslessAsPng)
{
  for (const Case& expected : kCases)
  {
    const cv::Mat image = noise({31, 17}, expected.type, /*row_padding=*/5);
    const cv::Mat before = image.clone();
    const CompressedImage png = compressed(image, expected.encoding, "png");
    EXPECT_EQ(png.format, expected.png_format);
    EXPECT_TRUE(equal(cv::imdecode(png.data, cv::IMREAD_UNCHANGED), converted(image, expected.stored)))
        << expected.encoding;
    const Decompressed back = decompressed(png);
    EXPECT_EQ(back.encoding, expected.encoding);
    EXPECT_TRUE(equal(back.image, opaque(image))) << expected.encoding;
    EXPECT_TRUE(equal(image, before));
  }
}

TEST(CompressedImage, equalsOpenCvAsJpeg)
{
  for (const Case& expected : kCases)
  {
    const cv::Mat image = noise({31, 17}, expected.type, /*row_padding=*/5);
    cv::Mat narrow;
    image.convertTo(narrow, CV_8U, image.depth() == CV_16U ? 255.0 / 65535.0 : 1.0);
    const cv::Mat stored = converted(narrow, expected.stored);
    const Bytes bytes = jpegOf(stored, {cv::IMWRITE_JPEG_QUALITY, 90});

    const CompressedImage jpeg = compressed(image, expected.encoding, "jpeg");
    EXPECT_EQ(jpeg.format, expected.jpeg_format);
    EXPECT_EQ(jpeg.data, bytes) << expected.encoding;
    const Decompressed back = decompressed(jpeg);
    EXPECT_EQ(back.encoding, jpeg.format.substr(0, jpeg.format.find(';')));
    const bool rgb = expected.encoding.rfind("rgb", 0) == 0;
    const cv::Mat decoded = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    const int code =
        narrow.channels() == 4 ? (rgb ? cv::COLOR_BGR2RGBA : cv::COLOR_BGR2BGRA) : (rgb ? cv::COLOR_BGR2RGB : -1);
    EXPECT_TRUE(equal(back.image, converted(decoded, code))) << expected.encoding;
  }
}

TEST(CompressedImage, storesYuvAsBgr)
{
  const cv::Mat image = noise({32, 16}, CV_8UC2), bgr = converted(image, "yuv422", "bgr8");
  const CompressedImage png = compressed(image, "yuv422", "png");
  EXPECT_EQ(png.format, "bgr8; png compressed bgr8");
  EXPECT_TRUE(equal(decompressed(png).image, bgr));
  // The label of the standard transport names the encoding from before the conversion.
  const Decompressed back = decompressed({"yuv422; png compressed bgr8", png.data});
  EXPECT_EQ(back.encoding, "bgr8");
  EXPECT_TRUE(equal(back.image, bgr));
}

TEST(CompressedImage, isReadWithoutALabel)
{
  const cv::Mat color = smooth({31, 17}), gray = converted(color, cv::COLOR_BGR2GRAY);
  cv::Mat wide;
  gray.convertTo(wide, CV_16U, 257.0);
  for (const std::string& format : {"jpeg", "jpg", "png", ""})
  {
    const std::string codec = format == "png" ? "png" : "jpeg";
    const Decompressed back = decompressed({format, compressed(color, "bgr8", codec).data});
    EXPECT_EQ(back.encoding, "bgr8");
    EXPECT_EQ(back.image.size(), color.size());
    EXPECT_EQ(decompressed({format, compressed(gray, "mono8", codec).data}).encoding, "mono8");
  }
  const Decompressed back = decompressed({"png", compressed(wide, "mono16", "png").data});
  EXPECT_EQ(back.encoding, "mono16");
  EXPECT_TRUE(equal(back.image, wide));
}

// OpenCV cannot write gray with alpha, and reads it as BGR.
TEST(CompressedImage, isBgrIfItIsGrayWithAlphaWithoutALabel)
{
  const Bytes gray_alpha = {0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48,
                            0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x04, 0x00, 0x00,
                            0x00, 0x5E, 0x2B, 0xB7, 0x01, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x44, 0x41, 0x54, 0x78,
                            0x9C, 0x63, 0x48, 0xF9, 0x7F, 0xE2, 0x3F, 0x00, 0x07, 0x21, 0x03, 0x2B, 0x82, 0x71,
                            0xD3, 0xB5, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};
  const Decompressed back = decompressed({"png", gray_alpha});
  EXPECT_EQ(back.encoding, "bgr8");
  EXPECT_TRUE(equal(back.image, cv::imdecode(gray_alpha, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR)));
  EXPECT_EQ(back.image.at<cv::Vec3b>(0, 1), cv::Vec3b(200, 200, 200));
}

TEST(CompressedImage, isReadInGrayAndInColor)
{
  const cv::Mat image = smooth({32, 16});
  for (const std::string codec : {"jpeg", "png"})
  {
    const CompressedImage coded = compressed(image, "rgb8", codec);
    const Decompressed gray = decompressed(coded, ColorMode::kGray);
    EXPECT_EQ(gray.encoding, "mono8");
    EXPECT_TRUE(equal(gray.image, cv::imdecode(coded.data, cv::IMREAD_GRAYSCALE)));
    const Decompressed color = decompressed(coded, ColorMode::kColor);
    EXPECT_EQ(color.encoding, "bgr8");
    EXPECT_TRUE(equal(color.image, cv::imdecode(coded.data, cv::IMREAD_COLOR)));
  }
  const cv::Mat mosaic = noise({32, 16}, CV_8UC1);
  const Decompressed color = decompressed(compressed(mosaic, "bayer_rggb8", "png"), ColorMode::kColor);
  EXPECT_EQ(color.encoding, "bgr8");
  EXPECT_TRUE(equal(color.image, converted(mosaic, "bayer_rggb8", "bgr8")));
}

TEST(CompressedImage, isReadSmaller)
{
  const cv::Mat image = smooth({61, 47});
  for (const std::string codec : {"jpeg", "png"})
  {
    cv::Mat expected;
    cv::resize(image, expected, {31, 24}, 0, 0, cv::INTER_AREA);
    const Decompressed half = decompressed(compressed(image, "bgr8", codec), ColorMode::kUnchanged, 2);
    ASSERT_EQ(half.image.size(), expected.size());
    EXPECT_LT(cv::norm(half.image, expected, cv::NORM_L1) / (31 * 24 * 3), 4.0) << codec;
    EXPECT_EQ(refusal([&] { decompressed(compressed(image, "bgr8", codec), ColorMode::kUnchanged, 3); }),
              "reduction is 3, must be 1, 2, 4 or 8");
  }
  EXPECT_EQ(refusal(
                [&] {
                  decompressed(compressed(noise({32, 16}, CV_8UC1), "bayer_rggb8", "png"), ColorMode::kUnchanged, 2);
                }),
            "a Bayer mosaic (bayer_rggb8) cannot be reduced");
}

TEST(CompressedImage, isRefusedIfItIsNotWhatItsLabelSays)
{
  const CompressedImage png = compressed(smooth({4, 4}), "bgr8", "png");
  const CompressedImage jpeg = compressed(smooth({4, 4}), "bgr8", "jpeg");
  const auto refused = [](const std::string& format, const Bytes& data) {
    return refusal([&] { decompressed({format, data}); });
  };
  EXPECT_EQ(refused(png.format, jpeg.data),
            "format is 'bgr8; png compressed bgr8', its " + std::to_string(jpeg.data.size()) + " bytes are JPEG");
  EXPECT_EQ(refused(jpeg.format, png.data),
            "format is 'bgr8; jpeg compressed bgr8', its " + std::to_string(png.data.size()) + " bytes are PNG");
  EXPECT_EQ(refused("bgr8; qoi compressed bgr8", {'q', 'o', 'i', 'f'}),
            "format is 'bgr8; qoi compressed bgr8', its 4 bytes are neither JPEG nor PNG");
  EXPECT_EQ(refused("jpeg", {}), "format is 'jpeg', its 0 bytes are neither JPEG nor PNG");
  EXPECT_EQ(refused("32FC1; png compressed ", png.data).find("encoding '32FC1' is not one of bgr8, "), 0u);
}

TEST(CompressedImage, refusesToCompressOtherEncodingsAndTypes)
{
  EXPECT_EQ(refusal([] { compressed(cv::Mat(2, 2, CV_32FC1), "32FC1", "png"); }).find("encoding '32FC1' is not"), 0u);
  EXPECT_EQ(refusal([] { compressed(cv::Mat(2, 2, CV_8UC1), "bgr8", "png"); }),
            "bgr8 image of 2x2: expected pixels of 3 x 8 bits (CV_8UC3), got 1 x 8 bits (CV_8UC1)");
  EXPECT_EQ(refusal([] { compressed(cv::Mat(2, 2, CV_8UC1), "mono8", "webp"); }),
            "format is 'webp', must be jpeg or png");
  EXPECT_EQ(refusalWith(&CompressionParams::png_level, 10), "png_level is 10, must be from 1 to 9");
}
