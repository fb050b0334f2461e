#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>

#include "robot_vision/depth/depth_error.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// A plane that a depth image shows. The point of the plane on the ray (x, y, 1) of the camera's optical frame has the
/// depth 1 / (a x + b y + c).
struct DepthPlane
{
  cv::Vec3d inverse_depth;  // a, b and c, 1/m
  cv::Matx33d covariance;   // of the three, 1/m^2
  int pixels = 0;           // whose depths agree with it
};

/// Throws std::invalid_argument unless the plane is finite and its covariance symmetric and positive definite.
void validate(const DepthPlane& plane);

/// Measures the plane of a tag whose corners (px, counter-clockwise as seen, as those of TagCorners are) were found in
/// the image of a camera. `depth` has that camera's size, lens and optical frame, as registered depth has: CV_32FC1 in
/// m, where what is not finite or not positive is unknown, or CV_16UC1 in mm, 0 where it is unknown (REP 118). Depths
/// that do not agree with the plane of most are left out. The result is empty if there are too few, if they scatter
/// much more than `params` tell, if no plane with a finite covariance follows from them, and if a corner is not finite
/// or more than 1e6 px away. Throws std::invalid_argument for an image of another type or size, and for a parameter out
/// of range.
std::optional<DepthPlane> measureTagPlane(const cv::Mat& depth, const std::array<cv::Point2d, 4>& corners,
                                          const CameraModel& camera,
                                          const DepthErrorParams& params = DepthErrorParams());

}  // namespace robot_vision
