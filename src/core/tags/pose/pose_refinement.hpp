#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "robot_vision/tags/pose/tag_pose.hpp"

namespace robot_vision
{

/// The corners of a tag of a body, and where a camera sees them.
struct SeenSquare
{
  std::array<cv::Point3d, 4> points;  // m, in the body's frame
  std::array<cv::Point2d, 4> pixels;
  CornerCovariance information;  // the inverse of the covariance of the pixels, 1/px^2
};

using Sighting = std::vector<SeenSquare>;

/// The pixels of four points by the shift of the frame that they are in, and its rotation about its origin, along the
/// camera's axes.
using MotionJacobian = cv::Matx<double, 8, 6>;
MotionJacobian pixelsByMotion(const std::array<cv::Point3d, 4>& points, const CameraModel& camera,
                              const cv::Affine3d& pose);

/// How well a pose explains a sighting.
struct PoseRefinement
{
  cv::Affine3d pose;
  cv::Matx66d covariance;  // of x, y, z and the rotations about x, y, z, along the camera's axes
  double cost = 0.0;       // sum of the squared residuals by their covariances; infinite if there is no such pose
};

/// The pose near `start` that explains a sighting best (Levenberg, Marquardt).
PoseRefinement fitPose(const Sighting& sighting, const CameraModel& camera, const cv::Affine3d& start);

/// The cost alone; infinite behind the camera.
double costOf(const Sighting& sighting, const CameraModel& camera, const cv::Affine3d& pose);

/// px, root mean square distance of the pixels from where a pose has them.
double errorOf(const Sighting& sighting, const CameraModel& camera, const cv::Affine3d& pose);

/// A pose that is shifted, and turned about its origin, along the camera's axes; and the way from one to another.
cv::Affine3d moved(const cv::Affine3d& pose, const cv::Vec6d& by);
cv::Vec6d difference(const cv::Affine3d& from, const cv::Affine3d& to);

}  // namespace robot_vision
