#pragma once

#include <opencv2/core.hpp>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// One camera of a pair, and how its images are rectified, by the fields of sensor_msgs/CameraInfo.
struct RectifiedCamera
{
  CameraModel model;
  cv::Matx33d R = cv::Matx33d::zeros();  // turns the optical frame into the one that both rectified cameras share

  // Of the rectified images: focal lengths and principal point, px, and of the right camera as P(0, 3) the focal length
  // times how far it is to the right of the left one, px m, negative.
  cv::Matx34d P = cv::Matx34d::zeros();
};

bool operator==(const RectifiedCamera& a, const RectifiedCamera& b);

/// The camera that sees the rectified images: K is that of P, and there is no distortion.
CameraModel rectifiedModel(const RectifiedCamera& camera);

/// Two cameras that were calibrated together, as by cv::stereoRectify.
struct StereoCamera
{
  RectifiedCamera left;
  RectifiedCamera right;
};

/// What turns the disparities of rectified images into places.
struct StereoGeometry
{
  double fx = 0.0;        // px, focal length along the rows
  double fy = 0.0;        // px, along the columns
  double cx = 0.0;        // px, principal point of the left image
  double cy = 0.0;        // px, of both images
  double offset = 0.0;    // px, cx of the left image minus that of the right one: the disparity at infinity
  double baseline = 0.0;  // m, between the cameras
};

/// Throws std::invalid_argument naming a field (as of CameraInfo) that no camera of a calibrated pair can have, its
/// value and what it must be: what validate() of the CameraModel refuses, skew, a size beyond 32767 px, an R or P that
/// is missing or that no rectified image has.
void validate(const RectifiedCamera& camera);

/// The same for both cameras, and for what makes no pair of them: images of two sizes, other focal lengths or rows, no
/// baseline to the right.
void validate(const StereoCamera& pair);

/// Throws as validate() does.
StereoGeometry geometryOf(const StereoCamera& pair);

}  // namespace robot_vision
