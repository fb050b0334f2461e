#pragma once

#include <linux/videodev2.h>

#include <string>

#include "robot_vision/camera/open_source.hpp"
#include "v4l2_device.hpp"
#include "v4l2_pixel_formats.hpp"

namespace robot_vision
{

/// The format, size and rate to which a device is set.
struct V4l2Mode
{
  const V4l2Format* format = nullptr;
  v4l2_pix_format pixels{};  // the driver's answer
  double rate = 0.0;         // Hz; 0 if the driver does not tell it
  std::string warning;       // how it differs from what was asked for, and what there is; empty if it does not differ
};

/// Sets the device to the usable mode that is nearest to `params`. The pixel format is the one of `params` if the
/// device offers it, else the one that offers the nearest size; then come the nearest size and the nearest rate. If the
/// driver does not list what it offers, all formats are tried one after the other. Throws SourceUnavailable if none is
/// usable.
V4l2Mode negotiateFormat(V4l2Device& device, const CaptureParams& params);

/// "YUYV 640x480"
std::string describe(const V4l2Mode& mode);

}  // namespace robot_vision
