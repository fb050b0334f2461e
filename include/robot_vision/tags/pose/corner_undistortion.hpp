#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// Where the corners of a tag are in the picture, from those that AprilTag finds: where straight lines meet that are
/// fitted to the edges (Wang, Olson: AprilTag 2, 2016). A lens bends the edges, and the lines of large tags meet some
/// tenths of a pixel beside the corners. `corners`: px, in their order around the tag. Returned as they are where the
/// camera has no rays.
std::array<cv::Point2d, 4> withoutBentEdges(const std::array<cv::Point2d, 4>& corners, const CameraModel& camera);

}  // namespace robot_vision
