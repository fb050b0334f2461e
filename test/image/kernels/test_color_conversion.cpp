#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/image/color_conversion.hpp"
#include "core/image/gray_weights.hpp"
#include "robot_vision/image/encoding.hpp"
#include "support/images.hpp"
#include "support/thread_counts.hpp"

using namespace robot_vision;

namespace
{

constexpr int kPlanes = -1;  // instead of a code of cv::cvtColor: the luma is a plane of the image

struct Conversion
{
  const char* encoding;
  int to_bgr;
  int to_rgb;
  int to_gray;
};

const Conversion kConversions[] = {
    {"yuv422", cv::COLOR_YUV2BGR_UYVY, cv::COLOR_YUV2RGB_UYVY, cv::COLOR_YUV2GRAY_UYVY},
    {"yuv422_yuy2", cv::COLOR_YUV2BGR_YUY2, cv::COLOR_YUV2RGB_YUY2, cv::COLOR_YUV2GRAY_YUY2},
    {"nv12", cv::COLOR_YUV2BGR_NV12, cv::COLOR_YUV2RGB_NV12, kPlanes},
    {"nv21", cv::COLOR_YUV2BGR_NV21, cv::COLOR_YUV2RGB_NV21, kPlanes},
    {"yu12", cv::COLOR_YUV2BGR_I420, cv::COLOR_YUV2RGB_I420, kPlanes},
    {"bayer_rggb8", cv::COLOR_BayerBG2BGR, cv::COLOR_BayerBG2RGB, cv::COLOR_BayerBG2GRAY},
    {"bayer_bggr8", cv::COLOR_BayerRG2BGR, cv::COLOR_BayerRG2RGB, cv::COLOR_BayerRG2GRAY},
    {"bayer_gbrg8", cv::COLOR_BayerGR2BGR, cv::COLOR_BayerGR2RGB, cv::COLOR_BayerGR2GRAY},
    {"bayer_grbg8", cv::COLOR_BayerGB2BGR, cv::COLOR_BayerGB2RGB, cv::COLOR_BayerGB2GRAY},
};

struct GrayConversion
{
  const char* encoding;
  int to_gray;
};

const GrayConversion kGrayConversions[] = {{"bgr8", cv::COLOR_BGR2GRAY},
                                           {"rgb8", cv::COLOR_RGB2GRAY},
                                           {"bgra8", cv::COLOR_BGRA2GRAY},
                                           {"rgba8", cv::COLOR_RGBA2GRAY}};

bool isBayer(const Conversion& conversion)
{
  return std::string(conversion.encoding).substr(0, 5) == "bayer";
}

/// The matrix size of the next larger image that this encoding allows.
cv::Size allowed(const Conversion& conversion, cv::Size size)
{
  if (isBayer(conversion)) return size;
  size.width += size.width % 2;
  return conversion.to_gray == kPlanes ? cv::Size(size.width, (size.height + 1) / 2 * 3) : size;
}

/// An image of adversarial() pixels inside of a larger one, whose pixels begin at any address.
class TestImage
{
public:
  TestImage(const std::string& encoding, const cv::Size& size, int kind)
  {
    const int type = matType(encoding);
    const cv::Mat bytes = adversarial({size.width * CV_MAT_CN(type), size.height}, kind);
    around_ = cv::Mat(size.height + 2, bytes.cols + 9, CV_8UC1, cv::Scalar(77));
    cv::Mat inside = around_(cv::Rect({1 + kind % 7, 1}, bytes.size()));
    bytes.copyTo(inside);
    image = cv::Mat(size, type, inside.data, inside.step);
  }

  cv::Mat image;

private:
  cv::Mat around_;
};

cv::Mat byOpenCv(const cv::Mat& image, int code)
{
  return code == kPlanes ? image.rowRange(0, image.rows * 2 / 3) : converted(image, code);
}

void expectOpenCvs(const Conversion& conversion, const cv::Size& wanted, int kind)
{
  const TestImage input(conversion.encoding, allowed(conversion, wanted), kind);
  const cv::Mat& image = input.image;
  const cv::Mat before = image.clone();
  const auto what = [&] { return cv::format("%s %d, %d threads ", conversion.encoding, kind, cv::getNumThreads()); };
  for (const auto& [wanted, code] :
       {std::pair{"bgr8", conversion.to_bgr}, {"rgb8", conversion.to_rgb}, {"mono8", conversion.to_gray}})
    ASSERT_TRUE(equal(converted(image, conversion.encoding, wanted), byOpenCv(image, code)))
        << what() << image.size() << ' ' << wanted;
  EXPECT_TRUE(equal(image, before));
}

void expectOpenCvsGray(const GrayConversion& conversion, const cv::Size& size, int kind)
{
  const TestImage input(conversion.encoding, size, kind);
  const cv::Mat before = input.image.clone();
  cv::Mat around(size.height, size.width + 70, CV_8UC1, cv::Scalar(77));
  cv::Mat gray = around.colRange(3, 3 + size.width);
  toGray(input.image, conversion.encoding, gray);
  EXPECT_EQ(cv::countNonZero(around.colRange(3 + size.width, around.cols) != 77), 0) << size;
  ASSERT_TRUE(equal(gray, byOpenCv(input.image, conversion.to_gray)))
      << conversion.encoding << ' ' << kind << ' ' << size << ' ' << cv::getNumThreads();
  EXPECT_TRUE(equal(input.image, before));
}

/// Tests with one thread and with several. Each number is set only once, because OpenCV takes a while to end and start
/// its threads.
class ColorConversionInThreads : public testing::TestWithParam<int>
{
  ThreadCount threads_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Counts, ColorConversionInThreads, testing::Values(1, 3));

}  // namespace

TEST_P(ColorConversionInThreads, equalsOpenCv)
{
  cv::RNG random(11);
  for (const Conversion& conversion : kConversions)
  {
    for (int i = 0; i < 150; ++i)
      expectOpenCvs(conversion, {random.uniform(1, 260), random.uniform(1, 24)}, i);
    for (const int columns : {1, 2, 3, 62, 63, 64, 65, 66, 67, 126, 127, 128, 129, 130, 131, 194})
      for (int rows = 1; rows < 5; ++rows)
        expectOpenCvs(conversion, {columns, rows}, 0);
    expectOpenCvs(conversion, {641, 480}, 0);  // enough for several threads
  }
  expectOpenCvs(kConversions[0], {4096, 270}, 0);
  expectOpenCvs(kConversions[4], {4096, 270}, 4);
  expectOpenCvs(kConversions[5], {4096, 270}, 1);
}

TEST(ColorConversion, equalsOpenCvForAllLumaAndChroma)
{
  cv::Mat image(256, 512, CV_8UC2);
  for (int u = 0; u < 256; u += 5)
  {
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x)
        image.at<cv::Vec2b>(y, x) =
            cv::Vec2b(static_cast<std::uint8_t>(y), static_cast<std::uint8_t>(x % 2 ? x / 2 : u));
    ASSERT_TRUE(equal(converted(image, "yuv422_yuy2", "bgr8"), converted(image, cv::COLOR_YUV2BGR_YUY2))) << u;
  }
}

TEST_P(ColorConversionInThreads, equalsOpenCvsGray)
{
  cv::RNG random(12);
  for (const GrayConversion& conversion : kGrayConversions)
  {
    for (int i = 0; i < 150; ++i)
      expectOpenCvsGray(conversion, {random.uniform(1, 260), random.uniform(1, 24)}, i);
    for (int columns = 1; columns < 135; ++columns)
      expectOpenCvsGray(conversion, {columns, 2}, 0);
    expectOpenCvsGray(conversion, {641, 480}, 0);
    expectOpenCvsGray(conversion, {4096, 270}, 4);
  }
}

TEST(ColorConversion, equalsOpenCvsGrayForEveryColor)
{
  const cv::Mat image = allColors();
  EXPECT_TRUE(equal(converted(image, "bgr8", "mono8"), converted(image, cv::COLOR_BGR2GRAY)));
  EXPECT_TRUE(equal(converted(image, "rgb8", "mono8"), converted(image, cv::COLOR_RGB2GRAY)));
}

TEST(ColorConversion, worksInPlace)
{
  for (const Conversion& conversion : kConversions)
  {
    const cv::Mat image = noise({96, 48}, matType(conversion.encoding));
    cv::Mat same = image;
    toBgr(same, conversion.encoding, same);
    EXPECT_TRUE(equal(same, byOpenCv(image, conversion.to_bgr))) << conversion.encoding;
    if (isBayer(conversion)) continue;  // OpenCV overwrites the mosaic while it reads it
    same = image;
    toGray(same, conversion.encoding, same);
    EXPECT_TRUE(equal(same, byOpenCv(image, conversion.to_gray))) << conversion.encoding;
  }
  for (const GrayConversion& conversion : kGrayConversions)
  {
    const cv::Mat image = noise({96, 48}, matType(conversion.encoding));
    cv::Mat same = image;
    toGray(same, conversion.encoding, same);
    EXPECT_TRUE(equal(same, byOpenCv(image, conversion.to_gray))) << conversion.encoding;
  }
}

// If OpenCV did the conversions, the tests above would compare it with itself.
TEST(ColorConversion, isDoneByOurKernelsOnWideVectors)
{
  const std::string set = name(currentSet());
  const bool wide = set.substr(0, 3) == "avx";
  cv::Mat pixels;
  for (const Conversion& conversion : kConversions)
    EXPECT_EQ(convertRows(noise({96, 48}, matType(conversion.encoding)), conversion.encoding, false, pixels), wide);
  const bool known = grayWeightsOfBgr() != nullptr;
  for (const GrayConversion& conversion : kGrayConversions)
    EXPECT_EQ(convertRowsToGray(noise({96, 48}, matType(conversion.encoding)), false, pixels), wide && known);
  if (!known) GTEST_SKIP() << "OpenCV converts to gray by weights that are not known here";
}
