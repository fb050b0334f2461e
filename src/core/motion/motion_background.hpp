#pragma once

#include <opencv2/core.hpp>
#include <opencv2/video/background_segm.hpp>
#include <string>

#include "core/image/conversion_buffer.hpp"
#include "frame_difference.hpp"
#include "robot_vision/motion/motion.hpp"

namespace robot_vision
{

/// The background that the frames of a stream are compared with. MotionDetector says what it is for each method.
class MotionBackground
{
public:
  /// The parameters must be valid.
  explicit MotionBackground(const MotionParams& params) : params_(params) {}

  /// Keeps the background, but not for another method. The parameters must be valid.
  void configure(const MotionParams& params);

  /// The image in the encoding in which it is compared, valid until the next call. May share the pixels of `image`.
  EncodedImage prepare(const cv::Mat& image, const std::string& encoding);

  /// Whether there is a background that a prepared image can be compared with, which had this encoding before.
  bool fits(const EncodedImage& image, const std::string& encoding) const
  {
    return size_ == image.pixels.size() && encoding_ == encoding;
  }

  /// Makes a prepared image the background, which had this encoding before.
  void begin(const EncodedImage& image, const std::string& encoding);

  /// Forgets the background.
  void clear();

  /// Writes into the mask, CV_8UC1 of the same size, where a prepared image differs from the background, and lets the
  /// background learn from the image. Returns a part outside of which the mask is black.
  cv::Rect compare(const EncodedImage& image, cv::Mat& mask);

private:
  cv::Rect compareWithModel(const EncodedImage& image, cv::Mat& mask);
  cv::Rect compareWithReference(const EncodedImage& image, cv::Mat& mask);
  void learn(const cv::Mat& gray);

  MotionParams params_;
  ConversionBuffer buffer_;
  cv::Size size_;         // of the image that is the background, empty if there is none
  std::string encoding_;  // of the same before it was prepared
  FrameDifference difference_;
  Reference reference_;  // blurred for first_frame only: with the other methods it changes in every frame
  cv::Mat average_;      // CV_32FC1, the reference before it is rounded
  cv::Mat relit_;        // the image as bright as the reference
  cv::Ptr<cv::BackgroundSubtractorMOG2> mog2_;
};

}  // namespace robot_vision
