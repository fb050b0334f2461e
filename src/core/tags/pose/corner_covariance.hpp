#pragma once

#include "robot_vision/tags/pose/tag_pose.hpp"

namespace robot_vision
{

/// Whether a matrix is symmetric, positive definite and finite, and not so near to the end of that that its inverse is
/// noise.
bool isCovariance(const CornerCovariance& matrix);

/// The inverse of a covariance, or of an inverse, of any unit; 0, which says nothing, where there is none.
CornerCovariance inverseOf(const CornerCovariance& matrix);

}  // namespace robot_vision
