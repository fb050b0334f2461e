#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace robot_vision
{

/// Converts YUV and Bayer mosaics of 8 bits to BGR or RGB, bit for bit as cv::cvtColor does, with as many threads as
/// cv::setNumThreads() allows. Returns false and does nothing where this is no faster than OpenCV: for other encodings,
/// images of a few columns, and on processors without SIMD. `image` must be valid for the encoding.
bool convertRows(const cv::Mat& image, const std::string& encoding, bool is_rgb, cv::Mat& pixels);

/// Converts pixels of three or four channels of 8 bits, in BGR or RGB order, to gray in the same way. Returns false for
/// fewer channels, on processors without SIMD, and if the arithmetic of this version of OpenCV is not known.
bool convertRowsToGray(const cv::Mat& image, bool is_rgb, cv::Mat& gray);

/// Copies the luma of yuv422 or yuv422_yuy2, with as many threads.
void copyLuma(const cv::Mat& image, const std::string& encoding, cv::Mat& luma);

}  // namespace robot_vision
