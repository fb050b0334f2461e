#pragma once

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// Writes `margin` pixels before and after a row of pixels, as OpenCV's `border` continues it.
template <class T>
void extendRow(T* row, int pixels, int channels, int margin, int border)
{
  for (int i = 1; i <= margin; ++i)
  {
    const T* const before = row + cv::borderInterpolate(-i, pixels, border) * channels;
    const T* const after = row + cv::borderInterpolate(pixels - 1 + i, pixels, border) * channels;
    std::copy_n(before, channels, row - i * channels);
    std::copy_n(after, channels, row + (pixels - 1 + i) * channels);
  }
}

/// A row of an image of bytes that OpenCV's `border` continues above and below.
inline const std::uint8_t* extendedRow(const cv::Mat& image, int y, int border)
{
  return image.ptr(cv::borderInterpolate(y, image.rows, border));
}

}  // namespace robot_vision
