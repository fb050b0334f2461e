#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace robot_vision
{

/// A picture and its encoding.
struct EncodedPicture
{
  cv::Mat pixels;
  std::string encoding;
};

/// What pictures are compared with.
struct Reference
{
  cv::Mat pixels;   // of the encoding that the pictures have
  cv::Mat gray;     // CV_8UC1
  cv::Mat blurred;  // the same blurred; empty: blurred anew each time, where it is needed
};

/// `gray` (CV_8UC1) blurred by a Gaussian.
cv::Mat blurred(const cv::Mat& gray, int blur_size);

/// Whether findChangedPixels() takes pictures of this encoding: what is grey in them is a mean of a pixel's own bytes.
bool isComparable(const std::string& encoding);

/// Makes a black mask 255 where a picture (of a comparable encoding and the reference's size, as the mask) differs from
/// the reference by more than `threshold` after a Gaussian blur of `blur_size`: cv::cvtColor, cv::GaussianBlur,
/// cv::absdiff and cv::threshold, to the bit. Converts and blurs only where that can be, so that a picture like the
/// other costs a look at each pixel. Returns the part of the mask that may have changed.
cv::Rect findChangedPixels(const EncodedPicture& picture, const Reference& reference, int blur_size, double threshold,
                           cv::Mat& mask);

}  // namespace robot_vision
