#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

namespace robot_vision
{

/// The homography that takes (0, 0), (1, 0), (1, 1), (0, 1) to four points: Heckbert, Fundamentals of Texture Mapping
/// and Image Warping, 1989.
cv::Matx33d fromUnitSquare(const std::array<cv::Point2d, 4>& p);

/// The two possible poses of a square, to first order: Collins and Bartoli, Infinitesimal Plane-Based Pose Estimation,
/// IJCV 2014. `rays` are those of its corners in TagCorners' order, `size` is its side in metres.
std::array<cv::Affine3d, 2> squarePoses(const std::array<cv::Point2d, 4>& rays, double size);

}  // namespace robot_vision
