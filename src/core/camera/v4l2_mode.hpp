#pragma once

#include <linux/videodev2.h>

#include <string>

#include "robot_vision/camera/frame_source.hpp"
#include "v4l2_device.hpp"
#include "v4l2_format.hpp"

namespace robot_vision
{

/// What a device and we have agreed on.
struct V4l2Mode
{
  const V4l2Format* format = nullptr;
  v4l2_pix_format pixels{};  // as the driver answered
  double rate = 0.0;         // Hz; 0: the driver does not say
  std::string warning;       // in what it differs from what was asked for, and what there is; empty if it does not
};

/// Sets the device to the nearest to `params` that it offers and that we take: their pixel format if it has that, else
/// the one that comes nearest in size; then the size, then the rate. A driver that does not say what it offers is asked
/// for one format after the other. Throws SourceUnavailable if the two do not come together.
V4l2Mode negotiateFormat(V4l2Device& device, const CaptureParams& params);

/// "YUYV 640x480"
std::string describe(const V4l2Mode& mode);

}  // namespace robot_vision
