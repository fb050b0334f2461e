#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// The image with columns appended to the right and rows below up to `size`, which is not smaller: zeros, or with
/// cv::BORDER_REPLICATE copies of the last ones. The image itself if it has this size.
inline cv::Mat filledUp(const cv::Mat& image, const cv::Size& size, int border = cv::BORDER_CONSTANT)
{
  if (image.size() == size) return image;
  cv::Mat larger;
  cv::copyMakeBorder(image, larger, 0, size.height - image.rows, 0, size.width - image.cols, border);
  return larger;
}

}  // namespace robot_vision
