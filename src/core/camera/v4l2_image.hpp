#pragma once

#include <linux/videodev2.h>

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>

#include "v4l2_mode.hpp"

namespace robot_vision
{

/// Says what is wrong with a filled buffer, to be appended to the frame's name; empty if nothing is.
std::string damageText(const v4l2_buffer& filled, const V4l2Mode& mode);

/// The image in a buffer that damageText() found good, in the mode's encoding, or its `bytes` bytes if it is
/// compressed. The image points into the buffer, except for YU12 with padded rows and for Y10B: they are copied to
/// `unpadded`, because their encodings have no padding, and 16 bits for a pixel.
cv::Mat imageIn(void* buffer, std::size_t bytes, const V4l2Mode& mode, cv::Mat& unpadded);

}  // namespace robot_vision
