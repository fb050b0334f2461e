#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "robot_vision/depth/planes.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// A frame on a plane: x and y along it, z its normal; the origin is the point of the plane nearest to the camera.
cv::Affine3d planeFrame(const Plane& plane);

/// Writes the convex hulls of the planes of labels (see PlaneSegmentation).
void findHulls(const cv::Mat& labels, const RayTable& rays, std::vector<Plane>& planes);

}  // namespace robot_vision
