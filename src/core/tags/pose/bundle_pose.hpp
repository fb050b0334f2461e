#pragma once

#include <vector>

#include "pose_refinement.hpp"
#include "robot_vision/tags/pose/tag_pose.hpp"

namespace robot_vision
{

/// A tag of a bundle that is seen, and where.
struct SeenTag
{
  BundleTag tag;
  std::array<cv::Point2d, 4> corners;
  CornerCovariance covariance;  // of what the picture leaves open
  bool measured;                // that is known from the picture
  double lens_variance;         // px^2, of each coordinate, of what the calibration leaves of the lens
};

/// The tags of a valid bundle that are seen; `variance`: px^2, of each coordinate of a corner of which no covariance is
/// known. Throws std::invalid_argument as estimatePose() does for corners.
std::vector<SeenTag> tagsOf(const Bundle& bundle, const std::vector<TagCorners>& seen, const CameraModel& camera,
                            double variance, double lens_variance);

/// All corners of the tags, with what the picture and the lens leave open; the layout is taken to be exact.
Sighting sightingOf(const std::vector<SeenTag>& tags, const CameraModel& camera);

/// The one or two poses that explain the tags' corners best, the best one first; none if there is no such pose in front
/// of the camera. Their covariances know that neighbouring tags share the lens' error, and how well the layout is
/// known.
std::vector<PoseRefinement> fitBody(const std::vector<SeenTag>& tags, const CameraModel& camera);

/// One of the poses of a body, and the probability that it is right.
struct WeighedPose
{
  PoseRefinement fit;
  double probability;
};

/// The one or two poses, the best one first; their errors are those of `sighting`.
TagPoses posesOf(const std::vector<WeighedPose>& poses, const Sighting& sighting, const CameraModel& camera);

}  // namespace robot_vision
