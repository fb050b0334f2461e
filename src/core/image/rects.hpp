#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// The rectangle that is all of an image.
inline cv::Rect fullRect(const cv::Mat& image)
{
  return {{0, 0}, image.size()};
}

/// A rectangle grown by `border` px on every side and cut off at the border of the image. Empty if `rect` is.
inline cv::Rect grown(const cv::Rect& rect, int border, const cv::Size& image)
{
  if (rect.empty()) return {};
  const cv::Rect larger(rect.x - border, rect.y - border, rect.width + 2 * border, rect.height + 2 * border);
  return larger & cv::Rect({0, 0}, image);
}

}  // namespace robot_vision
