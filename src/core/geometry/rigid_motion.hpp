#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <string>

namespace robot_vision
{

/// Whether a matrix is a rotation, up to 1e-3 in each element of R * R^T. False with NaN.
bool isRotation(const cv::Matx33d& R);

/// Throws std::invalid_argument naming the transform unless it is that of a rigid body by at most 1000 m along each
/// axis.
void requireRigid(const cv::Affine3d& transform, const std::string& name);

// A small motion of a body: a shift (m) and a rotation (rad) about its origin, along the camera's axes.

/// A pose moved by that, and the motion from one pose to another.
cv::Affine3d moved(const cv::Affine3d& pose, const cv::Vec6d& by);
cv::Vec6d difference(const cv::Affine3d& from, const cv::Affine3d& to);

/// The matrix whose product with a vector is the cross product of `v` and it.
cv::Matx33d crossMatrix(const cv::Vec3d& v);

/// What the covariance of a body's motions is when another point of the body is its origin, at `to_origin` (m) from the
/// one that it is now, along the camera's axes.
cv::Matx66d atOrigin(const cv::Matx66d& covariance, const cv::Vec3d& to_origin);

}  // namespace robot_vision
