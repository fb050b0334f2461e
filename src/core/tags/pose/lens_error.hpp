#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "robot_vision/tags/pose/tag_pose.hpp"

namespace robot_vision
{

/// How alike what a calibration leaves of a lens is in the corners of two tags: its correlation, of x with x and of y
/// with y, 0 to 1.
CornerCovariance distortionCorrelation(const std::array<cv::Point2d, 4>& one, const std::array<cv::Point2d, 4>& other,
                                       const CameraModel& camera);

/// Its covariance in the corners of a tag; `variance`: px^2, of each coordinate.
CornerCovariance lensError(const std::array<cv::Point2d, 4>& corners, double variance, const CameraModel& camera);

}  // namespace robot_vision
