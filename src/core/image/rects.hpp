#pragma once

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

#include "robot_vision/common/range.hpp"

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

/// A size whose sides are multiplied by `scale`, but at least 1 px long.
inline cv::Size scaledSize(const cv::Size& size, double scale)
{
  return {std::max(1, cvRound(size.width * scale)), std::max(1, cvRound(size.height * scale))};
}

/// A part of an image for a message: "region of 60x50 px at (4, 4)".
inline std::string regionText(const cv::Rect& r)
{
  return "region of " + toText(r.size()) + " px at (" + std::to_string(r.x) + ", " + std::to_string(r.y) + ")";
}

/// Throws std::invalid_argument naming the region and the size of the image unless it is inside of that.
inline void requireInside(const cv::Rect& region, const cv::Size& image)
{
  const std::int64_t right = std::int64_t{region.x} + region.width, bottom = std::int64_t{region.y} + region.height;
  const bool is_inside = region.width > 0 && region.height > 0 && region.x >= 0 && region.y >= 0 &&
                         right <= image.width && bottom <= image.height;
  if (!is_inside) throw std::invalid_argument(regionText(region) + " is not inside the image of " + toText(image));
}

}  // namespace robot_vision
