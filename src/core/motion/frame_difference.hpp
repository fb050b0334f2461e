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
  cv::Mat gray;     // CV_8UC1
  cv::Mat blurred;  // the same blurred; empty: blurred anew each time, where it is needed
};

/// `gray` (CV_8UC1) blurred by a Gaussian.
cv::Mat blurred(const cv::Mat& gray, int blur_size);

/// How pictures are compared.
struct Comparison
{
  int blur_size;     // px, side of the Gaussian
  double threshold;  // gray levels
  int dilate;        // px
};

/// Makes a mask 255 where a picture (of the reference's size and an encoding that GrayLineBuffer take) differs from the
/// reference, else 0: toGray(), cv::GaussianBlur, cv::absdiff, cv::threshold and cv::dilate (3x3, once per px), to the
/// bit, with as many threads as cv::setNumThreads() says. Blurs only near what differs, so that a picture like the
/// other costs little more than to make it gray. Keeps its memory from frame to frame. Where OpenCV is so old that its
/// Gaussian is another (before 4.5), it is OpenCV that works.
class FrameDifference
{
public:
  FrameDifference();
  ~FrameDifference();
  FrameDifference(FrameDifference&&) noexcept;
  FrameDifference& operator=(FrameDifference&&) noexcept;

  /// Writes all of the mask (CV_8UC1 of the size). Returns a part outside of which it is black.
  cv::Rect find(const EncodedPicture& picture, const Reference& reference, const Comparison& how, cv::Mat& mask);

  /// The same by OpenCV.
  static cv::Rect findByOpenCv(const EncodedPicture& picture, const Reference& reference, const Comparison& how,
                               cv::Mat& mask);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
