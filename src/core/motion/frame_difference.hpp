#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "motion_stripe.hpp"
#include "robot_vision/motion/motion.hpp"

namespace robot_vision
{

/// `gray` (CV_8UC1) blurred by a Gaussian.
cv::Mat blurred(const cv::Mat& gray, int blur_size);

/// Makes a mask that is 255 where an image differs from a reference of its size, and 0 elsewhere: toGray(),
/// cv::GaussianBlur, cv::absdiff, cv::threshold and cv::dilate (3x3, once per px), to the bit, with as many threads as
/// cv::setNumThreads() says. Blurs only around pixels that differ, so that an image like the reference costs little
/// more than to make it gray. Keeps its memory from frame to frame. Before version 4.5 OpenCV's Gaussian may be another
/// one; OpenCV itself then does the work.
class FrameDifference
{
public:
  /// Writes the whole mask (CV_8UC1 of the image's size), as blur_size, threshold and dilate say. Returns a part
  /// outside of which it is black. GrayLineBuffer must take the encoding.
  cv::Rect find(const EncodedImage& image, const Reference& reference, const MotionParams& params, cv::Mat& mask);

  /// The same, computed by OpenCV.
  static cv::Rect findByOpenCv(const EncodedImage& image, const Reference& reference, const MotionParams& params,
                               cv::Mat& mask);

private:
  std::optional<GaussWeights> weights_;
  bool are_exact_ = false;  // whether the weights give what this OpenCV's cv::GaussianBlur does
  std::vector<MotionStripe> stripes_;
};

}  // namespace robot_vision
