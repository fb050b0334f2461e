#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// What pictures are compared with: CV_8UC1, the picture itself and, where many are, the same blurred.
struct Reference
{
  cv::Mat picture;
  cv::Mat blurred;  // empty: blurred anew each time, where it is needed
};

/// `picture` (CV_8UC1) blurred by a Gaussian.
cv::Mat blurred(const cv::Mat& picture, int blur_size);

/// 255 where a picture (CV_8UC1, of the reference's size) differs from the reference by more than `threshold` after a
/// Gaussian blur of `blur_size`, and 0 elsewhere: cv::GaussianBlur, cv::absdiff and cv::threshold, to the bit. Blurs
/// only where that can be, so that a picture like the other costs a look at each pixel. Returns the part of the mask
/// that may have changed.
cv::Rect findChangedPixels(const cv::Mat& gray, const Reference& reference, int blur_size, double threshold,
                           cv::Mat& mask);

}  // namespace robot_vision
