#pragma once

#include <cstddef>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// Decodes an image file with the `flags` of cv::imread: PNG, JPEG, BMP, PNM, PAM, PFM, TIFF, WebP or Sun raster.
/// Returns an empty image if the file has another format or is damaged. Throws std::invalid_argument if the header
/// claims more than kMaxPixels, because OpenCV would fill the memory for a file of some kilobytes, and if a JPEG or a
/// PNG is damaged, because OpenCV would return the parts that are there of a JPEG, and libjpeg and libpng would print
/// what is wrong.
cv::Mat decodeImageFile(const unsigned char* data, std::size_t size, int flags);

}  // namespace robot_vision
