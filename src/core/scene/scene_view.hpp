#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "robot_vision/geometry/camera_model.hpp"
#include "scene_model.hpp"

// From geometry in the camera's optical frame to shapes in the picture.
namespace robot_vision::scene
{

using Polygon2 = std::vector<cv::Point2d>;
using Polygon3 = std::vector<cv::Point3d>;

/// A camera with its rays and how far they reach.
struct Lens
{
  explicit Lens(const CameraModel& model);

  CameraModel camera;
  RayTable rays;
  double reach_x, reach_y;  // |x| and |y| of the rays of all pixels and some around are below these
};

/// The camera of the scene: everything that fits a 4:3 picture is in view in all formats.
CameraModel sceneCamera(int width, int height);

/// Corners of a board in the frame of `pose_in_camera`'s parent: counter-clockwise for the viewer from bottom left.
Polygon3 corners(const cv::Affine3d& pose, const cv::Size2d& size);

/// True when the camera sees the face (+z) of a plane with this pose in its optical frame.
bool facesCamera(const cv::Affine3d& pose);

/// Silhouette of a ball around `center` (optical frame, m), exact.
Polygon2 ballOutline(const CameraModel& camera, const cv::Point3d& center, double radius, int points);

/// Outline of the line on the floor, optical frame.
Polygon3 lineOutline(const cv::Affine3d& world_in_camera);

/// The part of a polygon inside the view; all its points have z > 0. May be empty.
Polygon3 clipToView(const Polygon3& polygon, const Lens& lens);

/// The part of a polygon inside the picture, whose border lies half a pixel outside the outer pixel centres.
Polygon2 clipToPicture(const Polygon2& polygon, const CameraModel& camera);

/// Projects a polygon with each edge cut into `pieces`, because distortion bends it.
Polygon2 project(const Polygon3& polygon, const CameraModel& camera, int pieces);

/// True when two polygons, convex or not, share any area.
bool overlap(const Polygon2& a, const Polygon2& b);

}  // namespace robot_vision::scene
