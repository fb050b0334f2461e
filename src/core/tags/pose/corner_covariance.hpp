#pragma once

#include "robot_vision/tags/pose/tag_pose.hpp"

namespace robot_vision
{

/// The coordinates of corners, in the order of a CornerCovariance.
cv::Vec<double, 8> coordinatesOf(const std::array<cv::Point2d, 4>& corners);

/// True if a matrix is symmetric, positive definite and finite, and not so close to singular that its inverse is noise.
bool isCovariance(const CornerCovariance& matrix);

/// The inverse of a covariance or of an information matrix of any unit; if there is none, 0, which means no
/// information.
CornerCovariance inverseOf(const CornerCovariance& matrix);

/// The correlation between the errors that a lens's calibration leaves in the corners of two tags, or of one tag: of x
/// with x and of y with y, 0 to 1.
CornerCovariance distortionCorrelation(const std::array<cv::Point2d, 4>& one, const std::array<cv::Point2d, 4>& other,
                                       const CameraModel& camera);

}  // namespace robot_vision
