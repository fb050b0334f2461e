#pragma once

#include <opencv2/core.hpp>

namespace robot_vision
{

// OpenCV's disparities: CV_16SC1, in sixteenths of a pixel.

constexpr int kDisparityShift = 4;
constexpr int kDisparitySteps = 1 << kDisparityShift;  // in a pixel

/// What stands where there is none.
constexpr int invalidDisparity(int min_disparity)
{
  return (min_disparity - 1) * kDisparitySteps;
}

/// Sets those to `invalid` whose partner is not in the right image, and those with a pixel that is 0 in `left_seen` or
/// whose partner's is 0 in `right_seen` (CV_8UC1 of the same size, or empty: all is seen). Throws std::invalid_argument
/// if these do not fit.
void dropUnseen(cv::Mat& disparities, int invalid, const cv::Mat& left_seen, const cv::Mat& right_seen);

/// Writes them as CV_32FC1, px, with NaN where there is none.
void toPixels(const cv::Mat& disparities, int invalid, cv::Mat& out);

}  // namespace robot_vision
