#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace robot_vision
{

/// cv::cvtColor of YUV and of Bayer mosaics of 8 bits to BGR or RGB, to the bit, with as many threads as
/// cv::setNumThreads() says. False, and nothing done, where OpenCV is as fast: other encodings, pictures of a few
/// columns, and processors without vectors. `image` is a picture of the encoding.
bool convertRows(const cv::Mat& image, const std::string& encoding, bool is_rgb, cv::Mat& pixels);

/// cv::cvtColor of bgr8, rgb8, bgra8 and rgba8 to gray in the same way. False: other encodings, processors without
/// vectors, and an OpenCV whose arithmetic is not known.
bool convertRowsToGray(const cv::Mat& image, const std::string& encoding, cv::Mat& gray);

/// The luma of yuv422 or yuv422_yuy2, with as many threads.
void takeLuma(const cv::Mat& image, const std::string& encoding, cv::Mat& luma);

}  // namespace robot_vision
