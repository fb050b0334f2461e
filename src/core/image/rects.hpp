#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// A rectangle with `border` px more on every side, as far as the picture goes.
inline cv::Rect grown(const cv::Rect& rect, int border, const cv::Size& picture)
{
  if (rect.empty()) return {};
  const cv::Rect larger(rect.x - border, rect.y - border, rect.width + 2 * border, rect.height + 2 * border);
  return larger & cv::Rect({0, 0}, picture);
}

}  // namespace robot_vision
