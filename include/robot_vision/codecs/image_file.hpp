#pragma once

#include <cstddef>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// Decodes an image file with cv::imread's `flags`: PNG, JPEG, BMP, PNM, PAM, PFM, TIFF, WebP or Sun raster. Empty if
/// it is of no such format, or damaged. Throws std::invalid_argument if its header claims more than kMaxPixels: a file
/// of some kilobytes can claim an image that fills the memory, which OpenCV would make room for; and of a damaged JPEG,
/// of which OpenCV would show what there is, and have libjpeg print what is wrong.
cv::Mat decodeImageFile(const unsigned char* data, std::size_t size, int flags);

}  // namespace robot_vision
