#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "robot_vision/camera_model.hpp"

namespace robot_vision
{

/// Points of a body, and where a camera sees them.
struct Sighting
{
  std::vector<cv::Point3d> points;  // m, in the body's frame
  std::vector<cv::Point2d> pixels;
  std::vector<double> variances;  // px^2, of each coordinate of a pixel
};

/// How well a pose explains a sighting.
struct PoseFit
{
  cv::Affine3d pose;
  cv::Matx66d covariance;  // of x, y, z and the rotations about x, y, z, along the camera's axes
  double cost = 0.0;       // sum of the squared residuals by their variances; infinite if there is no such pose
};

/// The pose near `start` that explains a sighting best (Levenberg, Marquardt).
PoseFit fitPose(const Sighting& sighting, const CameraModel& camera, const cv::Affine3d& start);

/// The cost alone; infinite behind the camera.
double costOf(const Sighting& sighting, const CameraModel& camera, const cv::Affine3d& pose);

/// px, root mean square distance of the pixels from where a pose has them.
double errorOf(const Sighting& sighting, const CameraModel& camera, const cv::Affine3d& pose);

/// A pose that is shifted, and turned about its origin, along the camera's axes; and the way from one to another.
cv::Affine3d moved(const cv::Affine3d& pose, const cv::Vec6d& by);
cv::Vec6d difference(const cv::Affine3d& from, const cv::Affine3d& to);

}  // namespace robot_vision
