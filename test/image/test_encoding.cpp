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

cv::Mat byOpenCv(const cv::Mat& image, int code, double white = 65535.0)
{
  cv::Mat out = converted(image, code);
  if (out.depth() == CV_16U) out.convertTo(out, CV_8U, 255.0 / white);
  return out;
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
    const cv::Mat gray = converted(image, expected.encoding, "mono8");
    const cv::Mat bgr = converted(image, expected.encoding, "bgr8");
    ASSERT_EQ(gray.type(), CV_8UC1);
    ASSERT_EQ(bgr.type(), CV_8UC3);
    EXPECT_TRUE(equal(gray, byOpenCv(image, expected.to_gray, white)));
    EXPECT_TRUE(equal(bgr, byOpenCv(image, expected.to_bgr, white)));
    EXPECT_TRUE(equal(converted(image, expected.encoding, "rgb8"), converted(bgr, cv::COLOR_BGR2RGB)));
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
    EXPECT_EQ(converted(mosaic, encoding, "bgr8").at<cv::Vec3b>(8, 8), cv::Vec3b(0, 0, 200)) << encoding;
  }
}

TEST(Planes, shareTheirLuma)
{
  for (const std::string encoding : {"nv12", "nv21", "yu12"})
  {
    const cv::Mat image = noise({32, 36}, CV_8UC1);  // 24 rows of luma, 12 of chroma
    const cv::Mat gray = converted(image, encoding, "mono8");
    EXPECT_EQ(gray.data, image.data);
    EXPECT_EQ(gray.size(), cv::Size(32, 24));
    EXPECT_FALSE(gray.isSubmatrix());
  }
}

TEST(Mono10, isScaledToMono16WithoutLoss)
{
  cv::Mat ramp(1, 1024, CV_16UC1);
  for (int i = 0; i < 1024; ++i)
    ramp.at<std::uint16_t>(i) = static_cast<std::uint16_t>(i);
  const cv::Mat wide = converted(ramp, "mono10", "mono16");
  EXPECT_EQ(wide.at<std::uint16_t>(0), 0);
  EXPECT_EQ(wide.at<std::uint16_t>(1023), 65535);
  cv::Mat back;
  wide.convertTo(back, CV_16U, 1023.0 / 65535.0);
  EXPECT_TRUE(equal(back, ramp));
  EXPECT_EQ(refusal([] { converted(cv::Mat(4, 4, CV_8UC1), "mono8", "mono16"); }),
            "a mono8 image has no 16 bits to give as mono16");
}

TEST(ToEncoding, sharesPixelsThatNeedNoConversion)
{
  for (const char* encoding : {"yuv422", "bayer_gbrg8", "mono16", "rgb8"})
  {
    const cv::Mat image = noise({32, 24}, matType(encoding), 4);
    EXPECT_EQ(converted(image, encoding, encoding).data, image.data) << encoding;
  }
  EXPECT_EQ(refusal([] { converted(cv::Mat(4, 4, CV_8UC3), "bgr8", "yuv422"); }),
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
  const cv::Mat stream = rowOf(jpegOf(smooth({64, 48}))), bgr = cv::imdecode(stream, cv::IMREAD_COLOR);
  EXPECT_TRUE(equal(converted(stream, "jpeg", "mono8"), cv::imdecode(stream, cv::IMREAD_GRAYSCALE)));
  EXPECT_TRUE(equal(converted(stream, "jpeg", "bgr8"), bgr));
  EXPECT_TRUE(equal(converted(stream, "jpeg", "rgb8"), converted(bgr, cv::COLOR_BGR2RGB)));
}

TEST(Encodings, tellTheSizeOfAnImage)
{
  for (const std::string& encoding : encodings())
  {
    if (encoding == "jpeg") continue;
    const cv::Mat image = noise({6, 6}, matType(encoding));
    EXPECT_EQ(imageSize(image, encoding), converted(image, encoding, "bgr8").size()) << encoding;
  }
  EXPECT_EQ(imageSize(noise({8, 6}, CV_8UC1), "nv12"), cv::Size(8, 4));
  Bytes bytes = jpegOf(smooth({7, 5}));
  bytes.erase(bytes.end() - 20, bytes.end() - 2);  // a decoder would refuse it
  EXPECT_EQ(imageSize(rowOf(bytes), "jpeg"), cv::Size(7, 5));
  EXPECT_NE(refusal([] { imageSize(cv::Mat(6, 6, CV_8UC3), "mono8"); }), "");
}

TEST(Encodings, ofDepthsHaveATypeAndASizeButNoColors)
{
  for (const std::string encoding : {"16UC1", "32FC1"})
  {
    const int type = encoding == "16UC1" ? CV_16UC1 : CV_32FC1;
    EXPECT_TRUE(isDepthEncoding(encoding));
    EXPECT_FALSE(isEncoding(encoding) || isMessageEncoding(encoding)) << encoding;
    EXPECT_EQ(matType(encoding), type);
    const cv::Mat depths(6, 8, type, cv::Scalar(1));
    EXPECT_EQ(imageSize(depths, encoding), cv::Size(8, 6));
    EXPECT_EQ(converted(depths, encoding, encoding).data, depths.data);
    for (const char* wanted : {"bgr8", "rgb8", "mono8", "mono16"})
      EXPECT_NE(refusal([&] { converted(depths, encoding, wanted); }), "") << encoding << " as " << wanted;
    EXPECT_NE(refusal([&] { checkPixels(depths, encoding); }), "") << encoding;  // nodes take no depths for images
    EXPECT_NE(refusal([&] { imageSize(cv::Mat(6, 8, CV_8UC1), encoding); }), "") << encoding;
    EXPECT_NE(refusal([&] { converted(cv::Mat(), encoding, encoding); }), "") << encoding;
  }
  EXPECT_FALSE(isDepthEncoding("mono16"));
}

TEST(Pixels, areRefusedIfTheyAreNotOfTheEncoding)
{
  for (const std::string& encoding : encodings())
  {
    const int wrong = matType(encoding) == CV_8UC3 ? CV_8UC1 : CV_8UC3;
    EXPECT_THROW(converted(cv::Mat(6, 6, wrong), encoding, "mono8"), std::invalid_argument) << encoding;
    EXPECT_THROW(converted(cv::Mat(), encoding, "bgr8"), std::invalid_argument) << encoding;
  }
  EXPECT_THROW(converted(cv::Mat(4, 5, CV_8UC2), "yuv422", "bgr8"), std::invalid_argument);
  EXPECT_THROW(converted(cv::Mat(7, 4, CV_8UC1), "nv12", "bgr8"), std::invalid_argument);
}

TEST(Encodings, areNamedIfUnknown)
{
  const std::string reason = refusal([] { matType("rgb565"); });
  EXPECT_NE(reason.find("'rgb565'"), std::string::npos);
  EXPECT_NE(reason.find("bgr8"), std::string::npos);
}
