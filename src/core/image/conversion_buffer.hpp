#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{

/// Converts the images of a stream, each into the memory of the one before. An image that needs no conversion is not
/// copied: the returned image then shares the pixels of the input, so that it must neither be written to nor be kept
/// longer than the input.
class ConversionBuffer
{
public:
  /// The image as toGray() makes it, valid until the next call.
  cv::Mat gray(const cv::Mat& image, const std::string& encoding) { return convert(toGray, image, encoding); }

  /// The image as toBgr() makes it, valid until the next call.
  cv::Mat bgr(const cv::Mat& image, const std::string& encoding) { return convert(toBgr, image, encoding); }

  /// The image as toEncoding() makes it, valid until the next call.
  cv::Mat as(const std::string& wanted, const cv::Mat& image, const std::string& encoding)
  {
    const auto function = [&](const cv::Mat& from, const std::string& layout, cv::Mat& to)
    { toEncoding(from, layout, wanted, to); };
    return convert(function, image, encoding);
  }

  /// Returns the pixels of `converted`, the last image that was returned, as an image that may be kept. It takes the
  /// buffer's memory, or a copy if the pixels are those of the input.
  cv::Mat detach(const cv::Mat& converted)
  {
    return sharesPixels(converted, memory_) ? std::exchange(memory_, cv::Mat()) : converted.clone();
  }

private:
  template <class Function>
  cv::Mat convert(const Function& function, const cv::Mat& image, const std::string& encoding)
  {
    cv::Mat converted = memory_;
    function(image, encoding, converted);
    if (!sharesPixels(converted, image)) memory_ = converted;
    return converted;
  }

  cv::Mat memory_;
};

}  // namespace robot_vision
