#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "mesh_lens.hpp"
#include "robot_vision/geometry/camera_model.hpp"
#include "scene_model.hpp"

// These functions project geometry in the camera's optical frame to shapes in the image.
namespace robot_vision::scene
{

using Polygon2 = std::vector<cv::Point2d>;
using Polygon3 = std::vector<cv::Point3d>;

/// A camera with the rays of its pixels.
struct Lens
{
  explicit Lens(const CameraModel& model);

  CameraModel camera;
  RayTable rays;
  double max_x, max_y;  // |x| and |y| of all rays are below these, with a margin around the image
  MeshLens for_meshes;
};

/// The camera of the scene. Its focal length is such that images of all shapes show at least what a 4:3 image shows.
CameraModel sceneCamera(int width, int height);

/// Corners of a board of `size` (m) in the frame in which `pose` is given: counter-clockwise for the viewer, from the
/// bottom left one.
Polygon3 corners(const cv::Affine3d& pose, const cv::Size2d& size);

/// True if the camera sees the front (+z) of a plane that has this pose in the optical frame.
bool facesCamera(const cv::Affine3d& pose);

/// The exact silhouette of a ball around `center` (optical frame, m), as so many points in the image.
Polygon2 ballOutline(const CameraModel& camera, const cv::Point3d& center, double radius, int points);

/// Outline of the line on the floor in the optical frame.
Polygon3 lineOutline(const cv::Affine3d& world_in_camera);

/// The part of a polygon that the rays of the lens can meet; all its points have z > 0. It may be empty.
Polygon3 clipToView(const Polygon3& polygon, const Lens& lens);

/// The part of a polygon inside the image, whose border lies half a pixel outside the outer pixel centres.
Polygon2 clipToImage(const Polygon2& polygon, const CameraModel& camera);

/// Projects a polygon. Each edge is cut into `pieces`, because distortion bends it.
Polygon2 project(const Polygon3& polygon, const CameraModel& camera, int pieces);

/// True if all points of an outline, which has some, are inside the image.
bool insideImage(const Polygon2& outline, const CameraModel& camera);

/// True if two polygons, convex or not, overlap.
bool overlap(const Polygon2& a, const Polygon2& b);

}  // namespace robot_vision::scene
