#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <optional>
#include <string>
#include <vector>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// Of x and y of the first corner of a tag to x and y of the last one, px^2.
using CornerCovariance = cv::Matx<double, 8, 8>;

/// Where a camera sees a tag.
struct TagCorners
{
  int id = 0;
  // px in the (distorted) picture, of the outer edge of the black border: AprilTag's order, counter-clockwise for
  // somebody who looks at the tag, from the bottom left one.
  std::array<cv::Point2d, 4> corners;
  std::optional<CornerCovariance> covariance = std::nullopt;  // if it is known, as measureCorners() tells it: of what
                                                              // the picture leaves open, without the lens
};

/// A tag on a rigid body. Its frame is that of apriltag_ros: for somebody who looks at the tag x right, y up, z out of
/// it, the origin in its middle.
struct BundleTag
{
  int id = 0;
  double size = 0.0;                             // m, outer edge of the black border
  cv::Affine3d pose = cv::Affine3d::Identity();  // of the tag in the body's frame, m
  // How well that is known, standard deviations; the body's frame is where its layout is right on the whole.
  double shift_noise = 0.0;  // m, of x, y and z
  double turn_noise = 0.0;   // rad, about each axis
};

/// Tags on one rigid body.
struct Bundle
{
  std::string name;
  std::vector<BundleTag> tags;
};

/// A single tag as a bundle, the frame of which is the tag's own.
Bundle singleTag(int id, double size);

/// Throws std::invalid_argument naming what is wrong, its value and the range: no tags, an id below 0 or twice, a size
/// that is not positive, a pose that is none, a noise that is negative.
void validate(const Bundle& bundle);

/// A pose of a body in the camera's optical frame.
struct PoseEstimate
{
  cv::Affine3d pose;  // m
  // Of x, y, z (m) and the rotations about x, y, z (rad), all along the fixed axes of the camera's frame: the order and
  // the meaning of geometry_msgs/PoseWithCovariance.
  cv::Matx66d covariance;
  double error = 0.0;  // px, root mean square distance of the corners from where this pose has them
};

/// What the corners say of a pose. A plane that is seen from afar looks nearly the same when it is tilted to the other
/// side: the corners agree with two poses.
struct TagPoses
{
  PoseEstimate best;                  // its covariance holds the chance that it is the other one
  std::optional<PoseEstimate> other;  // if there is one
  double ratio = 0.0;                 // error of the best to that of the other, 0 if there is none; above 1: the best
                                      // one is so by how well each corner is known, or by what was seen before
  double probability = 1.0;           // that the best one is right, 0 to 1
};

/// The pose of a bundle, or of a tag, from the corners of its tags in one picture; others are left out. Each of the two
/// poses (Collins, Bartoli: Infinitesimal Plane-Based Pose Estimation, IJCV 2014) is where the squared distances of all
/// corners, in the picture as it is and weighed by their covariances, are least.
/// `noise`: px, 0.001 to 10, standard deviation of each coordinate of a corner of which no covariance is known;
/// `lens_noise`: px, 0 to 10, the same of what the calibration leaves of the lens, alike in corners that are near each
/// other. Nothing is returned if none of the tags is seen, or no pose in front of the camera is like it. Throws
/// std::invalid_argument as the two validate() do, for a noise out of range, and for corners that are no tag's, naming
/// them: not finite, not convex, in the wrong order, smaller than a pixel, where the camera has no rays, with a
/// covariance that is none, or of a tag that is there twice.
std::optional<TagPoses> estimatePose(const Bundle& bundle, const std::vector<TagCorners>& seen,
                                     const CameraModel& camera, double noise, double lens_noise);

}  // namespace robot_vision
