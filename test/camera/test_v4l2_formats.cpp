#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/camera/v4l2_pixel_formats.hpp"
#include "core/camera/v4l2_source.hpp"
#include "robot_vision/image/encoding.hpp"
#include "support/fake_v4l2.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// A format's layout in the driver's buffer, and OpenCV's codes to convert it.
struct Layout
{
  std::string name;
  std::uint32_t fourcc;
  unsigned bits_per_px;
  int type;
  int to_bgr;  // -1 if there is nothing to convert
  int to_gray;
  bool odd;  // whether odd sizes are possible
};

std::ostream& operator<<(std::ostream& out, const Layout& layout)
{
  return out << layout.name;
}

/// The rows of an image with `padding` bytes after each one. The chroma rows of YU12 have half the padding.
std::vector<unsigned char> padded(const cv::Mat& image, const Layout& layout, std::size_t padding)
{
  const bool yu12 = layout.fourcc == V4L2_PIX_FMT_YUV420;
  const std::size_t row_bytes = image.cols * image.elemSize();
  std::vector<unsigned char> bytes;
  for (int row = 0; row < image.rows; ++row)
  {
    const unsigned char* const begin = image.ptr(row);
    const int parts = yu12 && row >= image.rows * 2 / 3 ? 2 : 1;
    for (int part = 0; part < parts; ++part)
    {
      bytes.insert(bytes.end(), begin + part * row_bytes / parts, begin + (part + 1) * row_bytes / parts);
      bytes.insert(bytes.end(), padding / parts, 0xEE);
    }
  }
  return bytes;
}

cv::Mat convertedByOpenCv(const cv::Mat& image, int code, double white)
{
  cv::Mat out = image.clone();
  if (code >= 0) cv::cvtColor(image, out, code);
  if (out.depth() == CV_16U) out.convertTo(out, CV_8U, 255.0 / white);
  return out;
}

cv::Mat randomImage(const Layout& layout, cv::Size size)
{
  if (layout.bits_per_px == 12) size.height = size.height * 3 / 2;
  cv::Mat image = noise(size, layout.type).clone();
  if (layout.fourcc == V4L2_PIX_FMT_Y10 || layout.name == "yuvmono10") image &= 0x3FF;
  return image;
}

}  // namespace

class V4l2Formats : public testing::TestWithParam<Layout>
{
};

TEST_P(V4l2Formats, areConvertedAsOpenCvDoes)
{
  const Layout& layout = GetParam();
  for (cv::Size size : {cv::Size(64, 48), cv::Size(66, 50), cv::Size(37, 17)})
    for (const unsigned padding : {0U, 12U})
    {
      if (!layout.odd) size = {size.width & ~1, size.height & ~1};
      const cv::Mat image = randomImage(layout, size);
      FakeCamera camera;
      camera.formats = {{layout.fourcc,
                         layout.bits_per_px,
                         {{static_cast<unsigned>(size.width), static_cast<unsigned>(size.height), {30.0}}}}};
      camera.row_padding = padding;
      camera.frame_bytes = [&](const v4l2_pix_format&, unsigned) { return padded(image, layout, padding); };
      CaptureParams params;
      params.pixel_format = layout.name;
      params.image_width = size.width;
      params.image_height = size.height;
      V4l2Source source(camera.plug(), params);
      EXPECT_EQ(source.warning(), "");

      Frame frame;
      ASSERT_EQ(source.read(frame), ReadResult::kFrame);
      cv::Mat bgr;
      cv::Mat rgb;
      cv::Mat gray;
      toBgr(frame.image, frame.encoding, bgr);
      toEncoding(frame.image, frame.encoding, "rgb8", rgb);
      toGray(frame.image, frame.encoding, gray);
      const double white = frame.encoding == "mono10" ? 1023.0 : 65535.0;
      const cv::Mat expected = convertedByOpenCv(image, layout.to_bgr, white);
      const bool planar = layout.bits_per_px == 12;
      EXPECT_TRUE(equal(bgr, expected));
      cv::cvtColor(rgb, rgb, cv::COLOR_RGB2BGR);
      EXPECT_TRUE(equal(rgb, expected));
      EXPECT_TRUE(
          equal(gray, planar ? image.rowRange(0, size.height) : convertedByOpenCv(image, layout.to_gray, white)));
    }
}

INSTANTIATE_TEST_SUITE_P(
    All, V4l2Formats,
    testing::Values(
        Layout{"yuyv", V4L2_PIX_FMT_YUYV, 16, CV_8UC2, cv::COLOR_YUV2BGR_YUYV, cv::COLOR_YUV2GRAY_YUYV, false},
        Layout{"uyvy", V4L2_PIX_FMT_UYVY, 16, CV_8UC2, cv::COLOR_YUV2BGR_UYVY, cv::COLOR_YUV2GRAY_UYVY, false},
        Layout{"nv12", V4L2_PIX_FMT_NV12, 12, CV_8UC1, cv::COLOR_YUV2BGR_NV12, -1, false},
        Layout{"nv21", V4L2_PIX_FMT_NV21, 12, CV_8UC1, cv::COLOR_YUV2BGR_NV21, -1, false},
        Layout{"yu12", V4L2_PIX_FMT_YUV420, 12, CV_8UC1, cv::COLOR_YUV2BGR_IYUV, -1, false},
        Layout{"bgr24", V4L2_PIX_FMT_BGR24, 24, CV_8UC3, -1, cv::COLOR_BGR2GRAY, true},
        Layout{"rgb24", V4L2_PIX_FMT_RGB24, 24, CV_8UC3, cv::COLOR_RGB2BGR, cv::COLOR_RGB2GRAY, true},
        Layout{"grey", V4L2_PIX_FMT_GREY, 8, CV_8UC1, cv::COLOR_GRAY2BGR, -1, true},
        Layout{"y16", V4L2_PIX_FMT_Y16, 16, CV_16UC1, cv::COLOR_GRAY2BGR, -1, true},
        Layout{"y10", V4L2_PIX_FMT_Y10, 16, CV_16UC1, cv::COLOR_GRAY2BGR, -1, true},
        Layout{"yuvmono10", V4L2_PIX_FMT_YUYV, 16, CV_16UC1, cv::COLOR_GRAY2BGR, -1, true},
        Layout{"bayer_rggb8", V4L2_PIX_FMT_SRGGB8, 8, CV_8UC1, cv::COLOR_BayerBG2BGR, cv::COLOR_BayerBG2GRAY, true},
        Layout{"bayer_bggr8", V4L2_PIX_FMT_SBGGR8, 8, CV_8UC1, cv::COLOR_BayerRG2BGR, cv::COLOR_BayerRG2GRAY, true},
        Layout{"bayer_gbrg8", V4L2_PIX_FMT_SGBRG8, 8, CV_8UC1, cv::COLOR_BayerGR2BGR, cv::COLOR_BayerGR2GRAY, true},
        Layout{"bayer_grbg8", V4L2_PIX_FMT_SGRBG8, 8, CV_8UC1, cv::COLOR_BayerGB2BGR, cv::COLOR_BayerGB2GRAY, true}));

TEST(V4l2Formats, areRefusedIfTheFrameIsTooShort)
{
  FakeCamera camera;
  camera.frame_bytes = [](const v4l2_pix_format& format, unsigned)
  { return std::vector<unsigned char>(format.sizeimage - 1, 0); };
  camera.formats = {{V4L2_PIX_FMT_NV12, 12, {{64, 48, {30.0}}}}};
  CaptureParams params;
  params.pixel_format = "nv12";
  V4l2Source source(camera.plug(), params);
  Frame frame;
  try
  {
    source.read(frame);
    FAIL();
  }
  catch (const std::invalid_argument& e)
  {
    EXPECT_STREQ(e.what(), "/dev/video0: frame 0 has 4607 bytes instead of 4608");
  }
}

TEST(V4l2Formats, areThoseThatTheParameterTakes)
{
  CaptureParams params;
  params.pixel_format = "none";
  EXPECT_EQ(refusal([&] { validate(params); }), "pixel_format is 'none', must be " + v4l2FormatNames());
}
