#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// Corrects the corners that AprilTag finds for the lens. AprilTag takes the intersections of straight lines that it
/// fits to the edges (Wang, Olson: AprilTag 2, 2016). A lens bends the edges, so that the lines of large tags meet some
/// tenths of a pixel beside the corners. `corners` (px) are in their order around the tag. They are returned unchanged
/// where the camera has no rays, and where two neighbouring lines are almost parallel, which meet far away.
std::array<cv::Point2d, 4> withoutBentEdges(const std::array<cv::Point2d, 4>& corners, const CameraModel& camera);

}  // namespace robot_vision
