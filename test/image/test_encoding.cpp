#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "robot_vision/image/encoding.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

struct Conversion
{
  std::string encoding;
  int to_bgr;  // cv::ColorConversionCodes, -1: no conversion
  int to_gray;
};

std::ostream& operator<<(std::ostream& out, const Conversion& conversion)
{
  return out << conversion.encoding;
}

cv::Mat to8Bits(const cv::Mat& image, double white)
{
  cv::Mat narrow;
  image.convertTo(narrow, CV_8U, 255.0 / white);
  return narrow;
}

cv::Mat byOpenCv(const cv::Mat& image, int code, double white = 65535.0)
{
  cv::Mat out = image.clone();
  if (code >= 0) cv::cvtColor(image, out, code);
  return out.depth() == CV_16U ? to8Bits(out, white) : out;
}

}  // namespace

class Conversions : public testing::TestWithParam<Conversion>
{
};

TEST_P(Conversions, equalOpenCvAndLeaveTheInputAlone)
{
  const Conversion& expected = GetParam();
  const double white = expected.encoding == "mono10" ? 1023.0 : 65535.0;
  const bool pairs = expected.encoding.substr(0, 3) == "yuv";
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(2, 1), pairs ? cv::Size(38, 7) : cv::Size(37, 7)})
  {
    const cv::Mat image = noise(size, matType(expected.encoding), /*row_padding=*/10);
    const cv::Mat before = image.clone();
    cv::Mat gray;
    cv::Mat bgr;
    cv::Mat rgb;
    toEncoding(image, expected.encoding, "mono8", gray);
    toEncoding(image, expected.encoding, "bgr8", bgr);
    toEncoding(image, expected.encoding, "rgb8", rgb);
    ASSERT_EQ(gray.type(), CV_8UC1);
    ASSERT_EQ(bgr.type(), CV_8UC3);
    EXPECT_TRUE(equal(gray, byOpenCv(image, expected.to_gray, white)));
    EXPECT_TRUE(equal(bgr, byOpenCv(image, expected.to_bgr, white)));
    EXPECT_TRUE(equal(rgb, byOpenCv(bgr, cv::COLOR_BGR2RGB)));
    EXPECT_TRUE(equal(image, before));
  }
}

INSTANTIATE_TEST_SUITE_P(Encodings, Conversions,
                         testing::Values(Conversion{"bgr8", -1, cv::COLOR_BGR2GRAY},
                                         Conversion{"rgb8", cv::COLOR_RGB2BGR, cv::COLOR_RGB2GRAY},
                                         Conversion{"bgra8", cv::COLOR_BGRA2BGR, cv::COLOR_BGRA2GRAY},
                                         Conversion{"rgba8", cv::COLOR_RGBA2BGR, cv::COLOR_RGBA2GRAY},
                                         Conversion{"mono8", cv::COLOR_GRAY2BGR, -1},
                                         Conversion{"mono10", cv::COLOR_GRAY2BGR, -1},
                                         Conversion{"mono16", cv::COLOR_GRAY2BGR, -1},
                                         Conversion{"yuv422", cv::COLOR_YUV2BGR_UYVY, cv::COLOR_YUV2GRAY_UYVY},
                                         Conversion{"yuv422_yuy2", cv::COLOR_YUV2BGR_YUYV, cv::COLOR_YUV2GRAY_YUYV},
                                         Conversion{"bayer_rggb8", cv::COLOR_BayerBG2BGR, cv::COLOR_BayerBG2GRAY},
                                         Conversion{"bayer_bggr8", cv::COLOR_BayerRG2BGR, cv::COLOR_BayerRG2GRAY},
                                         Conversion{"bayer_gbrg8", cv::COLOR_BayerGR2BGR, cv::COLOR_BayerGR2GRAY},
                                         Conversion{"bayer_grbg8", cv::COLOR_BayerGB2BGR, cv::COLOR_BayerGB2GRAY},
                                         Conversion{"bayer_rggb16", cv::COLOR_BayerBG2BGR, cv::COLOR_BayerBG2GRAY},
                                         Conversion{"bayer_bggr16", cv::COLOR_BayerRG2BGR, cv::COLOR_BayerRG2GRAY},
                                         Conversion{"bayer_gbrg16", cv::COLOR_BayerGR2BGR, cv::COLOR_BayerGR2GRAY},
                                         Conversion{"bayer_grbg16", cv::COLOR_BayerGB2BGR, cv::COLOR_BayerGB2GRAY}));

// The constants above could be wrong in the same way as the code. In a mosaic with a single primary colour there is no
// doubt about the right pattern.
TEST(Bayer, convertsTheRedPixelsOfAMosaicToRed)
{
  for (const auto& [encoding, y, x] : {std::tuple{"bayer_rggb8", 0, 0}, std::tuple{"bayer_bggr8", 1, 1},
                                       std::tuple{"bayer_gbrg8", 1, 0}, std::tuple{"bayer_grbg8", 0, 1}})
  {
    cv::Mat mosaic(16, 16, CV_8UC1, cv::Scalar(0));
    for (int row = y; row < 16; row += 2)
      for (int column = x; column < 16; column += 2)
        mosaic.at<std::uint8_t>(row, column) = 200;
    cv::Mat bgr;
    toBgr(mosaic, encoding, bgr);
    EXPECT_EQ(bgr.at<cv::Vec3b>(8, 8), cv::Vec3b(0, 0, 200)) << encoding;
  }
}

TEST(Planes, shareTheirLuma)
{
  for (const auto& [encoding, to_bgr] :
       {std::pair{"nv12", cv::COLOR_YUV2BGR_NV12}, std::pair{"nv21", cv::COLOR_YUV2BGR_NV21},
        std::pair{"yu12", cv::COLOR_YUV2BGR_I420}})
  {
    const cv::Mat image = noise({32, 36}, CV_8UC1, 0);  // 24 rows of luma, 12 of chroma
    cv::Mat gray;
    cv::Mat bgr;
    cv::Mat rgb;
    toGray(image, encoding, gray);
    toBgr(image, encoding, bgr);
    toEncoding(image, encoding, "rgb8", rgb);
    EXPECT_EQ(gray.data, image.data);
    EXPECT_EQ(gray.size(), cv::Size(32, 24));
    EXPECT_FALSE(gray.isSubmatrix());
    EXPECT_TRUE(equal(bgr, byOpenCv(image, to_bgr)));
    EXPECT_TRUE(equal(rgb, byOpenCv(bgr, cv::COLOR_BGR2RGB)));
  }
}

TEST(Mono10, isScaledToMono16WithoutLoss)
{
  cv::Mat ramp(1, 1024, CV_16UC1);
  for (int i = 0; i < 1024; ++i)
    ramp.at<std::uint16_t>(i) = static_cast<std::uint16_t>(i);
  cv::Mat wide;
  toEncoding(ramp, "mono10", "mono16", wide);
  EXPECT_EQ(wide.at<std::uint16_t>(0), 0);
  EXPECT_EQ(wide.at<std::uint16_t>(1023), 65535);
  cv::Mat back;
  wide.convertTo(back, CV_16U, 1023.0 / 65535.0);
  EXPECT_TRUE(equal(back, ramp));
  EXPECT_EQ(refusal([&] { toEncoding(cv::Mat(4, 4, CV_8UC1), "mono8", "mono16", wide); }),
            "a mono8 image has no 16 bits to give as mono16");
}

TEST(ToEncoding, sharesPixelsThatNeedNoConversion)
{
  cv::Mat out;
  for (const char* encoding : {"yuv422", "bayer_gbrg8", "mono16", "rgb8"})
  {
    const cv::Mat image = noise({32, 24}, matType(encoding), 4);
    toEncoding(image, encoding, encoding, out);
    EXPECT_EQ(out.data, image.data) << encoding;
  }
  EXPECT_EQ(refusal([&] { toEncoding(cv::Mat(4, 4, CV_8UC3), "bgr8", "yuv422", out); }),
            "a bgr8 image cannot be converted to yuv422");
}

TEST(Encodings, thatOnlyCamerasHaveAreNotForMessages)
{
  for (const std::string& encoding : encodings())
  {
    const std::string only_cameras = " mono10 nv12 nv21 yu12 jpeg ";
    EXPECT_NE(isMessageEncoding(encoding), only_cameras.find(" " + encoding + " ") != std::string::npos) << encoding;
  }
  EXPECT_FALSE(isMessageEncoding("nv24"));
}

TEST(Encodings, jpegIsDecodedAsOpenCvDoes)
{
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", smooth({64, 48}), bytes);
  const cv::Mat stream(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data());
  cv::Mat gray;
  cv::Mat bgr;
  cv::Mat rgb;
  toGray(stream, "jpeg", gray);
  toBgr(stream, "jpeg", bgr);
  toEncoding(stream, "jpeg", "rgb8", rgb);
  EXPECT_TRUE(equal(gray, cv::imdecode(bytes, cv::IMREAD_GRAYSCALE)));
  EXPECT_TRUE(equal(rgb, byOpenCv(bgr, cv::COLOR_BGR2RGB)));
  EXPECT_TRUE(equal(bgr, cv::imdecode(bytes, cv::IMREAD_COLOR)));
}

TEST(Encodings, tellTheSizeOfAnImage)
{
  cv::Mat bgr;
  for (const std::string& encoding : encodings())
  {
    if (encoding == "jpeg") continue;
    const cv::Mat image = noise({6, 6}, matType(encoding));
    toBgr(image, encoding, bgr);
    EXPECT_EQ(pictureSize(image, encoding), bgr.size()) << encoding;
  }
  EXPECT_EQ(pictureSize(noise({8, 6}, CV_8UC1), "nv12"), cv::Size(8, 4));
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", smooth({7, 5}), bytes);
  bytes.erase(bytes.end() - 20, bytes.end() - 2);  // a decoder would refuse it
  EXPECT_EQ(pictureSize(cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data()), "jpeg"), cv::Size(7, 5));
  EXPECT_NE(refusal([] { pictureSize(cv::Mat(6, 6, CV_8UC3), "mono8"); }), "");
}

TEST(Pixels, areRefusedIfTheyAreNotOfTheEncoding)
{
  cv::Mat out;
  for (const std::string& encoding : encodings())
  {
    const int wrong = matType(encoding) == CV_8UC3 ? CV_8UC1 : CV_8UC3;
    EXPECT_THROW(toGray(cv::Mat(6, 6, wrong), encoding, out), std::invalid_argument) << encoding;
    EXPECT_THROW(toBgr(cv::Mat(), encoding, out), std::invalid_argument) << encoding;
  }
  EXPECT_THROW(toBgr(cv::Mat(4, 5, CV_8UC2), "yuv422", out), std::invalid_argument);
  EXPECT_THROW(toBgr(cv::Mat(7, 4, CV_8UC1), "nv12", out), std::invalid_argument);
}

TEST(Encodings, areNamedIfUnknown)
{
  try
  {
    matType("rgb565");
    FAIL();
  }
  catch (const std::invalid_argument& e)
  {
    EXPECT_NE(std::string(e.what()).find("'rgb565'"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("bgr8"), std::string::npos);
  }
}
