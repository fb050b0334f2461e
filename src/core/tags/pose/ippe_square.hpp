#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

namespace robot_vision
{

/// The two poses that a square may have, to first order: Collins and Bartoli, Infinitesimal Plane-Based Pose
/// Estimation, IJCV 2014. `rays`: of its corners, in TagCorners' order; `size`: m.
std::array<cv::Affine3d, 2> squarePoses(const std::array<cv::Point2d, 4>& rays, double size);

}  // namespace robot_vision
