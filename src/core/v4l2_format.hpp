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
  const char* name;  // as usb_cam's parameter pixel_format has it
  std::uint32_t fourcc;
  const char* encoding;       // see encoding.hpp
  unsigned row_bytes_per_px;  // in the first plane; 0: compressed
};

/// In the order in which they are tried if the driver does not have the one asked for.
constexpr std::array<V4l2Format, 5> kV4l2Formats = {{
    {"yuyv", V4L2_PIX_FMT_YUYV, "yuv422_yuy2", 2},
    {"uyvy", V4L2_PIX_FMT_UYVY, "yuv422", 2},
    {"nv12", V4L2_PIX_FMT_NV12, "nv12", 1},
    {"grey", V4L2_PIX_FMT_GREY, "mono8", 1},
    {"mjpeg", V4L2_PIX_FMT_MJPEG, "jpeg", 0},
}};

/// Null if there is none of that name or code.
const V4l2Format* findV4l2Format(const std::string& name);
const V4l2Format* findV4l2Format(std::uint32_t fourcc);

/// "YUYV 640x480"
std::string describeFormat(std::uint32_t fourcc, std::uint32_t width, std::uint32_t height);

}  // namespace robot_vision
