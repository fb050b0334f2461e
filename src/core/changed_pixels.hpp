#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

/// 255 where two pictures (CV_8UC1, of one size) differ by more than `threshold` after a Gaussian blur of `blur_size`,
/// and 0 elsewhere: cv::GaussianBlur, cv::absdiff and cv::threshold, to the bit. Blurs only where that can be, so that
/// a picture like the other costs a look at each pixel. Returns the part of the mask that may have changed.
cv::Rect findChangedPixels(const cv::Mat& gray, const cv::Mat& reference, int blur_size, double threshold,
                           cv::Mat& mask);

/// `picture` (CV_8UC1) blurred, within `part`; to the bit as if all of it were.
cv::Mat blurPart(const cv::Mat& picture, const cv::Rect& part, int blur_size);

}  // namespace robot_vision
