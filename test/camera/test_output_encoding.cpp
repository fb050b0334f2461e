#include <gtest/gtest.h>

#include <tuple>

#include "core/camera/v4l2_pixel_formats.hpp"
#include "robot_vision/camera/output_encoding.hpp"
#include "robot_vision/image/encoding.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

TEST(OutputEncoding, isChosenByWhatTheCameraGives)
{
  const std::vector<std::tuple<std::string, std::string, std::string>> table = {
      {"bgr8", "bgr8", "bgr8"},      {"rgb8", "bgr8", "rgb8"},      {"mono8", "mono8", "mono8"},
      {"mono10", "mono8", "mono16"}, {"mono16", "mono8", "mono16"}, {"bayer_gbrg8", "bgr8", "bayer_gbrg8"},
      {"yuv422", "bgr8", "yuv422"},  {"nv12", "bgr8", "bgr8"},      {"nv21", "bgr8", "bgr8"},
      {"yu12", "bgr8", "bgr8"},      {"jpeg", "bgr8", "bgr8"},      {"yuv422_yuy2", "bgr8", "yuv422_yuy2"},
  };
  for (const auto& [given, automatic, native] : table)
  {
    EXPECT_EQ(outputEncoding("auto", given), automatic) << given;
    EXPECT_EQ(outputEncoding("native", given), native) << given;
    for (const char* asked : {"bgr8", "rgb8", "mono8"})
      EXPECT_EQ(outputEncoding(asked, given), asked) << given;
  }
}

TEST(OutputEncoding, leavesDepthsAsTheyAre)
{
  for (const char* wanted : {"auto", "bgr8", "rgb8", "mono8", "native"})
    for (const char* given : {"16UC1", "32FC1"})
      EXPECT_EQ(outputEncoding(wanted, given), given) << wanted;
}

TEST(OutputEncoding, canBeConvertedFromAllCameraFormats)
{
  for (const V4l2Format& format : kV4l2Formats)
  {
    if (format.encoding == std::string("jpeg")) continue;
    const cv::Mat image = cv::Mat::zeros(24, 32, matType(format.encoding));
    for (const char* wanted : {"auto", "bgr8", "rgb8", "mono8", "native"})
    {
      validateOutputEncoding(wanted);
      const std::string encoding = outputEncoding(wanted, format.encoding);
      cv::Mat out;
      toEncoding(image, format.encoding, encoding, out);
      EXPECT_EQ(out.type(), matType(encoding)) << format.name << " as " << wanted;
    }
  }
}

TEST(OutputEncoding, isRefusedIfUnknown)
{
  EXPECT_EQ(refusal([] { validateOutputEncoding("yuv"); }),
            "output_encoding is 'yuv', must be auto, bgr8, rgb8, mono8 or native");
}
