#pragma once

#include <memory>
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

/// Whether ChangedPixels::find() takes pictures of this encoding: what is grey in them is a mean of a pixel's own
/// bytes.
bool isComparable(const std::string& encoding);

/// How pictures are compared.
struct Comparison
{
  int blur_size;     // px, side of the Gaussian
  double threshold;  // grey levels
  int dilate;        // px
};

/// Makes a mask 255 where a picture (of a comparable encoding and the reference's size, as the mask) differs from the
/// reference, else 0: cv::cvtColor, cv::GaussianBlur, cv::absdiff, cv::threshold and cv::dilate (3x3, once per px), to
/// the bit, with as many threads as cv::setNumThreads() says. Does so only where they can differ, so that a picture
/// like the other costs a look at each pixel. Keeps its memory from frame to frame. Where OpenCV is so old that its
/// Gaussian is another (before 4.5), it is OpenCV that works.
class ChangedPixels
{
public:
  ChangedPixels();
  ~ChangedPixels();
  ChangedPixels(ChangedPixels&&) noexcept;
  ChangedPixels& operator=(ChangedPixels&&) noexcept;

  /// The mask is black outside of `white` before, and outside of what is returned then.
  cv::Rect find(const EncodedPicture& picture, const Reference& reference, const Comparison& how, const cv::Rect& white,
                cv::Mat& mask);

  /// The same by OpenCV.
  static cv::Rect findByOpenCv(const EncodedPicture& picture, const Reference& reference, const Comparison& how,
                               const cv::Rect& white, cv::Mat& mask);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
