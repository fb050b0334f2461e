#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

// The inverse of depth is what planes are linear in: w = a x + b y + c for the rays (x, y, 1) of a camera. A sensor
// whose standard deviation grows with the square of the depth, as of all that measure disparities, has the same
// deviation of w everywhere, so that unweighted sums of w are the best ones.

/// Writes inverse depths (CV_32FC1, 1/m; 0: none) of an image of depths into `inverse`, which is reused if it fits.
/// There is none where the camera has no ray. The image must be one of `encoding`, of the camera's size.
void invertDepth(const cv::Mat& depth, const std::string& encoding, const RayTable& rays, cv::Mat& inverse);

/// Whether two inverse depths can be of one surface: both are there, and differ by the factor `max_ratio` at most.
inline bool isOneSurface(float a, float b, float max_ratio)
{
  return (a > 0.0F) & (b > 0.0F) & (a <= max_ratio * b) & (b <= max_ratio * a);
}

}  // namespace robot_vision
