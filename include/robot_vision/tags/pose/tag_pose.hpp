#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <optional>
#include <string>
#include <vector>

#include "robot_vision/geometry/camera_model.hpp"
#include "tag_plane.hpp"

namespace robot_vision
{

/// Covariance of x and y of the first corner of a tag to x and y of the last one, px^2.
using CornerCovariance = cv::Matx<double, 8, 8>;

/// The corners of a tag in an image.
struct TagCorners
{
  int id = 0;
  // The corners of the outer edge of the black border, px in the (distorted) image, in AprilTag's order:
  // counter-clockwise for somebody who looks at the tag, from the bottom left one.
  std::array<cv::Point2d, 4> corners;
  // The uncertainty that the image leaves, if measureCorners() has determined it. It does not contain the error of the
  // lens's calibration.
  std::optional<CornerCovariance> covariance = std::nullopt;
  // The tag's plane in a depth image of the same time, if measureTagPlane() has found it.
  std::optional<DepthPlane> plane = std::nullopt;
};

/// A tag on a rigid body. Its frame is that of apriltag_ros: for somebody who looks at the tag, x points right, y up
/// and z out of the tag; the origin is in its middle.
struct BundleTag
{
  int id = 0;
  double size = 0.0;                             // m, outer edge of the black border
  cv::Affine3d pose = cv::Affine3d::Identity();  // of the tag in the body's frame, m
  // The standard deviations of this pose. The body's frame is the one in which its layout is right on average.
  double shift_noise = 0.0;  // m, of x, y and z
  double turn_noise = 0.0;   // rad, about each axis
};

/// Tags on one rigid body.
struct Bundle
{
  std::string name;
  std::vector<BundleTag> tags;
};

/// A single tag as a bundle whose frame is the tag's own.
Bundle singleTag(int id, double size);

/// Throws std::invalid_argument naming what is wrong, its value and the range: a bundle without tags, an id below 0 or
/// used twice, a size that is not positive, an invalid pose, or a noise out of range.
void validate(const Bundle& bundle);

/// A pose of a body in the camera's optical frame.
struct PoseEstimate
{
  cv::Affine3d pose;  // m
  // Covariance of x, y, z (m) and the rotations about x, y, z (rad), all along the fixed axes of the camera's frame, in
  // the order and with the meaning of geometry_msgs/PoseWithCovariance.
  cv::Matx66d covariance;
  double error = 0.0;  // px, root mean square distance of the corners from their projections
};

/// The one or two poses that agree with the corners. A plane seen from afar looks nearly the same when it is tilted to
/// the other side, so that there may be two.
struct TagPoses
{
  PoseEstimate best;                  // its covariance includes the possibility that the other one is right
  std::optional<PoseEstimate> other;  // empty if there is only one
  // The error of the best pose divided by that of the other, 0 if there is no other. It is above 1 if the covariances
  // of the corners, or the frames before, made the pose with the larger error the better one.
  double ratio = 0.0;
  double probability = 1.0;  // that the best one is right, 0 to 1
  int planes = 0;            // of tags in a depth image, which the best one explains, too
};

/// Estimates the pose of a bundle, or of a single tag, from the corners of its tags in one image; other tags are
/// ignored. Both poses (Collins, Bartoli: Infinitesimal Plane-Based Pose Estimation, IJCV 2014) minimise the squared
/// distances of all corners in the distorted image, weighted by their covariances.
/// `noise` (px, 0.001 to 10) is the standard deviation of each coordinate of a corner whose covariance is not known.
/// `lens_noise` (px, 0 to 10) is that of the error that the calibration of the lens leaves; it is similar in corners
/// near each other.
/// Where a tag comes with a plane, the pose explains both: corners and plane are weighted by their covariances. A plane
/// that no pose near those of the corners explains (its squared error is one of the largest in 100000) is of
/// something else, or its sensor is wrong: it is left out.
/// The result is empty if none of the tags is seen, or if no pose in front of the camera explains the
/// corners. Throws std::invalid_argument as validate() does for the bundle and the camera, for a noise out of range,
/// and for corners that no tag can have, naming them: corners that are not finite, not convex, in the wrong order,
/// smaller than a pixel or where the camera has no rays, an invalid covariance or plane, and a tag that is seen twice.
std::optional<TagPoses> estimatePose(const Bundle& bundle, const std::vector<TagCorners>& seen,
                                     const CameraModel& camera, double noise, double lens_noise);

}  // namespace robot_vision
