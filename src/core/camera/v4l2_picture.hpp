#pragma once

#include <linux/videodev2.h>

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>

#include "v4l2_mode.hpp"

namespace robot_vision
{

/// What is wrong with a filled buffer, to follow the frame's name; empty if nothing is.
std::string damageOf(const v4l2_buffer& filled, const V4l2Mode& mode);

/// The picture in a buffer of `bytes`, which damageOf() has nothing against, as its encoding has it; if it is
/// compressed, its bytes. It lies in the buffer, but for planes with padded rows, which encodings do not know: they are
/// copied to `unpadded`.
cv::Mat pictureIn(void* buffer, std::size_t bytes, const V4l2Mode& mode, cv::Mat& unpadded);

}  // namespace robot_vision
