#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "robot_vision/filters/brightness.hpp"
#include "robot_vision/image/encoding.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// cv::Mat::convertTo, then cv::LUT with the curve of OpenCV's tutorial on gamma correction.
cv::Mat byOpenCv(const cv::Mat& image, const BrightnessParams& p)
{
  cv::Mat linear;
  image.convertTo(linear, -1, p.gain, p.offset);
  cv::Mat curve(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i)
    curve.at<std::uint8_t>(i) = cv::saturate_cast<std::uint8_t>(std::pow(i / 255.0, p.gamma) * 255.0);
  cv::Mat out;
  cv::LUT(linear, curve, out);
  return out;
}

cv::Mat adjusted(const cv::Mat& image, const std::string& encoding, const BrightnessParams& params = {})
{
  cv::Mat out;
  Brightness(params).apply(image, encoding, out);
  return out;
}

/// byOpenCv() with the alpha channel of `image`.
cv::Mat withAlpha(const cv::Mat& image, const BrightnessParams& params)
{
  cv::Mat out = byOpenCv(image, params);
  const int alpha[] = {3, 3};
  cv::mixChannels(&image, 1, &out, 1, alpha, 1);
  return out;
}

const BrightnessParams kTable[] = {{}, {1.5, -20, 1}, {0, 0, 1}, {0.3, 200, 0.45}, {10, -255, 10}};

}  // namespace

TEST(Brightness, equalsTheOpenCvChain)
{
  for (const BrightnessParams& params : kTable)
    for (const std::string encoding : {"bgr8", "rgb8", "mono8", "bgra8", "rgba8"})
      for (const cv::Size size : {cv::Size(64, 48), cv::Size(1, 1), cv::Size(17, 3)})
      {
        const cv::Mat image = noise(size, matType(encoding), 5);
        const cv::Mat before = image.clone();
        const cv::Mat expected = image.channels() == 4 ? withAlpha(image, params) : byOpenCv(image, params);
        EXPECT_TRUE(equal(adjusted(image, encoding, params), expected))
            << encoding << ", gain " << params.gain << ", " << size;
        EXPECT_TRUE(equal(image, before));
        EXPECT_EQ(Brightness::outputEncoding(encoding), encoding);
      }
}

TEST(Brightness, isTheSameWithAnyNumberOfThreads)
{
  for (const std::string encoding : {"bgr8", "mono8", "rgba8", "mono16", "yuv422"})
    for (const int rows : {1, 40, 333})
    {
      const cv::Mat image = noise({50, rows}, matType(encoding), 5);
      BrightnessParams params{1.5, -20, 1};
      const cv::Mat alone = adjusted(image, encoding, params);
      for (params.threads = 2; params.threads <= 64; params.threads *= 2)
        EXPECT_TRUE(equal(adjusted(image, encoding, params), alone)) << encoding << " " << rows << params.threads;
    }
}

TEST(Brightness, convertsMosaicsAndYuvToBgr)
{
  for (const std::string& encoding : encodings())
  {
    const bool kept = Brightness::outputEncoding(encoding) == encoding;
    if (kept || encoding == "jpeg") continue;
    const cv::Mat image = noise({40, 30}, matType(encoding), 5);
    EXPECT_EQ(Brightness::outputEncoding(encoding), "bgr8");
    EXPECT_TRUE(equal(adjusted(image, encoding), byOpenCv(converted(image, encoding, "bgr8"), {}))) << encoding;
  }
}

TEST(Brightness, equalsTheFormulaFor16Bits)
{
  for (const BrightnessParams& params : kTable)
  {
    const cv::Mat image = noise({31, 9}, CV_16UC1, 5);
    cv::Mat linear;
    image.convertTo(linear, -1, params.gain, params.offset * 257);
    cv::Mat expected = linear.clone();
    for (auto& value : cv::Mat_<std::uint16_t>(expected))
      value = cv::saturate_cast<std::uint16_t>(std::pow(value / 65535.0, params.gamma) * 65535.0);
    EXPECT_TRUE(equal(adjusted(image, "mono16", params), expected)) << params.gain;
  }
}

TEST(Brightness, isVisiblyBrighterByDefault)
{
  const cv::Mat out = adjusted(cv::Mat(4, 4, CV_8UC3, cv::Scalar(10, 100, 250)), "bgr8");
  EXPECT_EQ(out.at<cv::Vec3b>(2, 2), cv::Vec3b(60, 150, 255));
}

TEST(Brightness, refusesParametersOutOfRange)
{
  EXPECT_EQ(refusal([] { Brightness{BrightnessParams{1, 0, 11}}; }), "gamma is 11, must be from 0.1 to 10");
  for (const BrightnessParams& params : kTable)
    EXPECT_NO_THROW(validate(params));
}
