#pragma once

#include <linux/videodev2.h>

#include <array>
#include <cstdint>
#include <string>

namespace robot_vision
{

/// A pixel format that V4l2Source takes from a driver.
struct V4l2Format
{
  const char* name;  // value of the parameter pixel_format; usb_cam's name if it has one
  std::uint32_t fourcc;
  const char* encoding;  // see encoding.hpp; for h264 the encoding of the decoded images
  bool compressed;
};

/// The formats in order of preference if the driver does not have the one asked for. The last two are further names
/// that usb_cam has; yuvmono10 is for cameras that give 10-bit gray but call it YUYV. y10b is gray of 10 bits without
/// gaps between the pixels.
inline constexpr std::array<V4l2Format, 20> kV4l2Formats = {{
    {"yuyv", V4L2_PIX_FMT_YUYV, "yuv422_yuy2", false},
    {"uyvy", V4L2_PIX_FMT_UYVY, "yuv422", false},
    {"nv12", V4L2_PIX_FMT_NV12, "nv12", false},
    {"nv21", V4L2_PIX_FMT_NV21, "nv21", false},
    {"yu12", V4L2_PIX_FMT_YUV420, "yu12", false},
    {"bgr24", V4L2_PIX_FMT_BGR24, "bgr8", false},
    {"rgb24", V4L2_PIX_FMT_RGB24, "rgb8", false},
    {"mjpeg", V4L2_PIX_FMT_MJPEG, "jpeg", true},
    {"bayer_rggb8", V4L2_PIX_FMT_SRGGB8, "bayer_rggb8", false},
    {"bayer_bggr8", V4L2_PIX_FMT_SBGGR8, "bayer_bggr8", false},
    {"bayer_gbrg8", V4L2_PIX_FMT_SGBRG8, "bayer_gbrg8", false},
    {"bayer_grbg8", V4L2_PIX_FMT_SGRBG8, "bayer_grbg8", false},
    {"h264", V4L2_PIX_FMT_H264, "yu12", true},
    {"grey", V4L2_PIX_FMT_GREY, "mono8", false},
    {"y16", V4L2_PIX_FMT_Y16, "mono16", false},
    {"y10", V4L2_PIX_FMT_Y10, "mono10", false},
    {"y10b", V4L2_PIX_FMT_Y10BPACK, "mono10", false},
    {"z16", V4L2_PIX_FMT_Z16, "16UC1", false},
    {"yuv", V4L2_PIX_FMT_YUYV, "yuv422_yuy2", false},
    {"yuvmono10", V4L2_PIX_FMT_YUYV, "mono10", false},
}};

/// The format with this name or code; null if there is none.
const V4l2Format* findV4l2Format(const std::string& name);
const V4l2Format* findV4l2Format(std::uint32_t fourcc);

/// "yuyv, uyvy, ... or yuvmono10"
std::string v4l2FormatNames();

/// "YUYV"
std::string fourccText(std::uint32_t fourcc);

/// "YUYV 640x480"
std::string describeFormat(std::uint32_t fourcc, std::uint32_t width, std::uint32_t height);

}  // namespace robot_vision
