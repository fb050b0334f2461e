#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// The best place of each cell of an image for a point that Lucas-Kanade flow is to follow: that with the largest
/// smaller eigenvalue of the gradients around it (Shi, Tomasi: Good Features to Track, CVPR 1994), if that is enough.
/// Every third row and column is looked at, which is near enough to any corner.
///
/// `derivatives` (CV_16SC2) are those that cv::buildOpticalFlowPyramid makes of the image. No place is where `mask`
/// (CV_8UC1 of the same size, or empty) is not 0. There are about as many cells as `count`.
std::vector<cv::Point2f> flowCorners(const cv::Mat& derivatives, const cv::Mat& mask, int count);

}  // namespace robot_vision
