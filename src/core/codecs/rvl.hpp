#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

// RVL (A. D. Wilson, "Fast Lossless Depth Image Compression", 2017) as compressed_depth_image_transport writes it:
// width and height, each of 32 bits, then runs of pixels that are 0 and of pixels that are not, of which the
// differences are coded, in groups of 3 bits.

/// Appends the stream of an image (CV_16UC1) to `out`.
void encodeRvl(const cv::Mat& image, std::vector<std::uint8_t>& out);

/// Decodes to CV_16UC1. Throws std::invalid_argument if the stream is truncated or damaged, or claims more than
/// kMaxPixels.
cv::Mat decodeRvl(const unsigned char* data, std::size_t size);

}  // namespace robot_vision
