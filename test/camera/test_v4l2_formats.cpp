#include <gtest/gtest.h>

#include "core/camera/v4l2_pixel_formats.hpp"
#include "core/camera/v4l2_source.hpp"
#include "robot_vision/image/encoding.hpp"
#include "support/fake_v4l2.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// A format's layout in the driver's buffer.
struct Layout
{
  std::string name;
  std::uint32_t fourcc;
  unsigned bits_per_px;
  std::string encoding;
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

}  // namespace

class V4l2Formats : public testing::TestWithParam<Layout>
{
};

TEST_P(V4l2Formats, giveTheDriversPixelsWithoutItsPadding)
{
  const Layout& layout = GetParam();
  for (cv::Size size : {cv::Size(64, 48), cv::Size(66, 50), cv::Size(37, 17)})
    for (const unsigned padding : {0U, 12U})
    {
      if (!layout.odd) size = {size.width & ~1, size.height & ~1};
      const cv::Size stored(size.width, layout.bits_per_px == 12 ? size.height * 3 / 2 : size.height);
      const cv::Mat image = noise(stored, matType(layout.encoding));
      FakeCamera camera;
      camera.formats = {{layout.fourcc,
                         layout.bits_per_px,
                         {{static_cast<unsigned>(size.width), static_cast<unsigned>(size.height), {30.0}}}}};
      camera.row_padding = padding;
      camera.frame_bytes = [&](const v4l2_pix_format&, unsigned) { return padded(image, layout, padding); };
      V4l2Source source(camera.plug(), withFormat(layout.name, size.width, size.height));
      EXPECT_EQ(source.warning(), "");

      Frame frame;
      ASSERT_EQ(source.read(frame), ReadResult::kFrame);
      EXPECT_EQ(frame.encoding, layout.encoding);
      EXPECT_TRUE(equal(frame.image, image));
    }
}

INSTANTIATE_TEST_SUITE_P(All, V4l2Formats,
                         testing::Values(Layout{"yuyv", V4L2_PIX_FMT_YUYV, 16, "yuv422_yuy2", false},
                                         Layout{"uyvy", V4L2_PIX_FMT_UYVY, 16, "yuv422", false},
                                         Layout{"nv12", V4L2_PIX_FMT_NV12, 12, "nv12", false},
                                         Layout{"nv21", V4L2_PIX_FMT_NV21, 12, "nv21", false},
                                         Layout{"yu12", V4L2_PIX_FMT_YUV420, 12, "yu12", false},
                                         Layout{"bgr24", V4L2_PIX_FMT_BGR24, 24, "bgr8", true},
                                         Layout{"rgb24", V4L2_PIX_FMT_RGB24, 24, "rgb8", true},
                                         Layout{"grey", V4L2_PIX_FMT_GREY, 8, "mono8", true},
                                         Layout{"y16", V4L2_PIX_FMT_Y16, 16, "mono16", true},
                                         Layout{"y10", V4L2_PIX_FMT_Y10, 16, "mono10", true},
                                         Layout{"yuvmono10", V4L2_PIX_FMT_YUYV, 16, "mono10", true},
                                         Layout{"z16", V4L2_PIX_FMT_Z16, 16, "16UC1", true},
                                         Layout{"bayer_rggb8", V4L2_PIX_FMT_SRGGB8, 8, "bayer_rggb8", true},
                                         Layout{"bayer_bggr8", V4L2_PIX_FMT_SBGGR8, 8, "bayer_bggr8", true},
                                         Layout{"bayer_gbrg8", V4L2_PIX_FMT_SGBRG8, 8, "bayer_gbrg8", true},
                                         Layout{"bayer_grbg8", V4L2_PIX_FMT_SGRBG8, 8, "bayer_grbg8", true}));

// The most significant bit of each pixel comes first, as the kernel's documentation of Y10B has it: Y'00[9:2],
// Y'00[1:0]Y'01[9:4], ...
TEST(V4l2Formats, giveGrayOf10BitsWithoutGapsAsNumbers)
{
  for (const unsigned padding : {0U, 6U})
  {
    const cv::Mat image = noise({64, 48}, CV_16UC1) & 1023;
    FakeCamera camera;
    camera.formats = {{V4L2_PIX_FMT_Y10BPACK, 10, {{64, 48, {30.0}}}}};
    camera.row_padding = padding;
    camera.frame_bytes = [&](const v4l2_pix_format&, unsigned)
    {
      std::vector<unsigned char> bytes;
      for (int y = 0; y < image.rows; ++y)
      {
        for (int bit = 0; bit < 10 * image.cols; ++bit)
        {
          if (bit % 8 == 0) bytes.push_back(0);
          const int value = image.at<std::uint16_t>(y, bit / 10) >> (9 - bit % 10) & 1;
          bytes.back() = static_cast<unsigned char>(bytes.back() | value << (7 - bit % 8));
        }
        bytes.insert(bytes.end(), padding, 0xEE);
      }
      return bytes;
    };
    V4l2Source source(camera.plug(), withFormat("y10b", 64, 48));
    EXPECT_EQ(source.warning(), "");
    Frame frame;
    ASSERT_EQ(source.read(frame), ReadResult::kFrame);
    EXPECT_EQ(frame.encoding, "mono10");
    EXPECT_TRUE(equal(frame.image, image));
  }
}

TEST(V4l2Formats, areDepthsIfTheCameraHasNothingElse)
{
  FakeCamera camera;
  camera.formats = {{V4L2_PIX_FMT_Z16, 16, {{64, 48, {30.0}}}}};
  V4l2Source source(camera.plug(), withFormat("yuyv", 64, 48));
  EXPECT_EQ(source.warning(), "/dev/video0: asked for YUYV 64x48, gives Z16 64x48; it offers Z16: 64x48");
  Frame frame;
  ASSERT_EQ(source.read(frame), ReadResult::kFrame);
  EXPECT_EQ(frame.encoding, "16UC1");
}

TEST(V4l2Formats, areRefusedIfTheFrameIsTooShort)
{
  FakeCamera camera;
  camera.frame_bytes = [](const v4l2_pix_format& format, unsigned)
  { return std::vector<unsigned char>(format.sizeimage - 1, 0); };
  camera.formats = {{V4L2_PIX_FMT_NV12, 12, {{64, 48, {30.0}}}}};
  V4l2Source source(camera.plug(), withFormat("nv12", 64, 48));
  Frame frame;
  EXPECT_EQ(refusal([&] { source.read(frame); }), "/dev/video0: frame 0 has 4607 bytes instead of 4608");
}

TEST(V4l2Formats, areThoseThatTheParameterTakes)
{
  EXPECT_EQ(refusalWith(&CaptureParams::pixel_format, "none"), "pixel_format is 'none', must be " + v4l2FormatNames());
}
