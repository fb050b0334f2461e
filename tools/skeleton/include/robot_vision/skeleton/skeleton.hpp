#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct SkeletonParams
{
  double threshold = 128.0;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("threshold", &SkeletonParams::threshold, Range{0, 255}, "gray levels", "pixels above it are bright");
  }
};

/// The share of the pixels that are bright, 0 to 1. `image` is not modified.
/// Throws std::invalid_argument as validate() does, or if `image` is not an image of `encoding` (see encoding.hpp).
double measureSkeleton(const cv::Mat& image, const std::string& encoding,
                       const SkeletonParams& params = SkeletonParams());

}  // namespace robot_vision
