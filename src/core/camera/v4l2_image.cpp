#include "v4l2_image.hpp"

#include <algorithm>
#include <cstdint>

#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

std::size_t rowStep(const V4l2Mode& mode)
{
  const bool packed = mode.format->fourcc == V4L2_PIX_FMT_Y10BPACK;
  const std::size_t pixel_bits = packed ? 10 : 8 * std::size_t{CV_ELEM_SIZE(matType(mode.format->encoding))};
  return std::max<std::size_t>(mode.pixels.bytesperline, (mode.pixels.width * pixel_bits + 7) / 8);
}

int rowsOf(const V4l2Mode& mode)
{
  const int height = static_cast<int>(mode.pixels.height);
  switch (mode.format->fourcc)
  {
    case V4L2_PIX_FMT_NV12:
    case V4L2_PIX_FMT_NV21:
    case V4L2_PIX_FMT_YUV420:
      return height * 3 / 2;
    default:
      return height;
  }
}

/// Removes the padding of YU12 rows. The driver's chroma rows have half the length of the luma rows, including the
/// padding; our encoding has two chroma rows without padding in one row of the image.
void unpadYu12(unsigned char* buffer, int width, int height, std::size_t step, cv::Mat& out)
{
  out.create(height * 3 / 2, width, CV_8UC1);
  const cv::Mat luma(height, width, CV_8UC1, buffer, step);
  luma.copyTo(out.rowRange(0, height));
  const cv::Mat chroma(height, width / 2, CV_8UC1, buffer + step * height, step / 2);
  cv::Mat packed(height, width / 2, CV_8UC1, out.ptr(height));
  chroma.copyTo(packed);
}

/// Gives each pixel of Y10B 16 bits. Its 10 bits follow those of the pixel before, the most significant one first.
void unpackY10b(const unsigned char* buffer, cv::Size size, std::size_t step, cv::Mat& out)
{
  out.create(size, CV_16UC1);
  for (int y = 0; y < size.height; ++y)
  {
    const unsigned char* const row = buffer + step * static_cast<std::size_t>(y);
    auto* const pixels = out.ptr<std::uint16_t>(y);
    for (int x = 0; x < size.width; ++x)
    {
      const int first_bit = 10 * x;  // which is at an even place of its byte, so that the last is in the next byte
      const unsigned char* const bytes = row + first_bit / 8;
      const unsigned both = static_cast<unsigned>(bytes[0]) << 8U | bytes[1];
      pixels[x] = static_cast<std::uint16_t>(both >> (6 - first_bit % 8) & 0x3FFU);
    }
  }
}

}  // namespace

std::string damageText(const v4l2_buffer& filled, const V4l2Mode& mode)
{
  if ((filled.flags & V4L2_BUF_FLAG_ERROR) != 0) return "is marked as damaged by the driver";
  if (filled.bytesused == 0) return "is empty";
  if (mode.format->compressed) return "";
  const std::size_t bytes = rowStep(mode) * static_cast<std::size_t>(rowsOf(mode));
  if (filled.bytesused >= bytes) return "";
  return "has " + std::to_string(filled.bytesused) + " bytes instead of " + std::to_string(bytes);
}

cv::Mat imageIn(void* buffer, std::size_t bytes, const V4l2Mode& mode, cv::Mat& unpadded)
{
  if (mode.format->compressed) return {1, static_cast<int>(bytes), CV_8UC1, buffer};
  const int width = static_cast<int>(mode.pixels.width);
  const std::size_t step = rowStep(mode);
  if (mode.format->fourcc == V4L2_PIX_FMT_Y10BPACK)
  {
    unpackY10b(static_cast<const unsigned char*>(buffer), {width, rowsOf(mode)}, step, unpadded);
    return unpadded;
  }
  const cv::Mat image(rowsOf(mode), width, matType(mode.format->encoding), buffer, step);
  if (mode.format->fourcc != V4L2_PIX_FMT_YUV420 || image.isContinuous()) return image;
  unpadYu12(image.data, width, static_cast<int>(mode.pixels.height), step, unpadded);
  return unpadded;
}

}  // namespace robot_vision
