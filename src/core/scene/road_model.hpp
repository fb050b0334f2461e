#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "scene_view.hpp"

// The road of the RoadScene: an oval that is driven around to the left, in the world frame of scene_model.hpp with the
// origin in its middle.
namespace robot_vision::scene
{

const cv::Scalar kGrass(70, 120, 85);  // BGR, around the road
const cv::Scalar kSky(222, 200, 172);  // BGR, above the horizon, which high images show

/// The size of the image of the road (m).
cv::Size2d roadSize();

/// The road from above, CV_8UC3: ahead (x) upwards.
cv::Mat roadImage();

/// The frame of the lane after so many metres on its middle: x ahead, y to the left, z up.
cv::Affine3d laneFrame(double along);

/// The robot's frame on the floor at a time of the motion (s), and the frame of the lane beside it.
struct RoadPlace
{
  cv::Affine3d robot, lane;
  double along;  // m, on the lane's middle
};
RoadPlace roadPlace(double seconds);

/// The optical frame of the camera that is mounted on a robot, in the world.
cv::Affine3d mountedCamera(const cv::Affine3d& robot);

/// The part of the lane ahead that a camera may see, between the middles of its lines: in the world, on the floor.
Polygon3 laneAhead(double along);

}  // namespace robot_vision::scene
