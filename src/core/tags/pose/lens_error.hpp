#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "robot_vision/tags/pose/tag_pose.hpp"

namespace robot_vision
{

/// The correlation between the errors that a lens's calibration leaves in the corners of two tags: of x with x and of y
/// with y, 0 to 1.
CornerCovariance distortionCorrelation(const std::array<cv::Point2d, 4>& one, const std::array<cv::Point2d, 4>& other,
                                       const CameraModel& camera);

/// The covariance of these errors in the corners of one tag; `variance` (px^2) is that of each coordinate.
CornerCovariance lensError(const std::array<cv::Point2d, 4>& corners, double variance, const CameraModel& camera);

}  // namespace robot_vision
