#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <optional>
#include <vector>

#include "robot_vision/tags/pose/tag_pose.hpp"

namespace robot_vision
{

/// The plane of a tag of a body, and where a depth image shows it.
struct SeenPlane
{
  cv::Vec3d normal, point;  // of the plane in the body's frame; m
  cv::Vec3d inverse_depth;  // as in DepthPlane
  cv::Matx33d covariance;
};

/// The corners of a tag of a body, and their pixels in an image.
struct SeenSquare
{
  std::array<cv::Point3d, 4> points;  // m, in the body's frame
  std::array<cv::Point2d, 4> pixels;
  CornerCovariance information;    // the inverse of the covariance of the pixels, 1/px^2
  std::optional<SeenPlane> plane;  // if there is a depth image, too
};

/// All tags of a body that are seen in an image.
using Observation = std::vector<SeenSquare>;

/// The derivatives of the pixels of four points by the shift of their frame and its rotation about its origin, along
/// the camera's axes.
using MotionJacobian = cv::Matx<double, 8, 6>;
MotionJacobian motionJacobian(const std::array<cv::Point3d, 4>& points, const CameraModel& camera,
                              const cv::Affine3d& pose);

/// The derivatives of a plane's inverse depth by the same motion of the body's frame.
using PlaneJacobian = cv::Matx<double, 3, 6>;
PlaneJacobian planeJacobian(const SeenPlane& plane, const cv::Affine3d& pose);

/// A pose that was fitted to an observation.
struct PoseRefinement
{
  cv::Affine3d pose;
  cv::Matx66d covariance;  // of x, y, z and the rotations about x, y, z, along the camera's axes
  double cost = 0.0;       // sum of the squared residuals divided by their covariances; infinite if the fit failed
  int planes = 0;          // that are a part of the observation
};

/// The pose near `start` that explains an observation best, by the method of Levenberg and Marquardt.
PoseRefinement fitPose(const Observation& observation, const CameraModel& camera, const cv::Affine3d& start);

/// The observation without its planes.
Observation cornersOnly(Observation observation);

/// The squared distance of a plane from where a fit that does not know of it has it, by the covariances of both.
double planeDistance(const SeenPlane& plane, const PoseRefinement& fit);

/// The cost of a pose; infinite if a tag is behind the camera.
double costOf(const Observation& observation, const CameraModel& camera, const cv::Affine3d& pose);

/// The root mean square distance (px) of the pixels from their projections by a pose.
double errorOf(const Observation& observation, const CameraModel& camera, const cv::Affine3d& pose);

}  // namespace robot_vision
