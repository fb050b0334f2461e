#pragma once

#include <vector>

#include "pose_refinement.hpp"
#include "robot_vision/tags/pose/tag_pose.hpp"

namespace robot_vision
{

/// A tag of a bundle with its corners in the image.
struct SeenTag
{
  BundleTag tag;
  std::array<cv::Point2d, 4> corners;
  CornerCovariance covariance;  // the uncertainty that the image leaves
  bool measured;                // whether the covariance was measured in the image
  double lens_variance;         // px^2, of each coordinate: the error that the calibration of the lens leaves
  std::optional<DepthPlane> plane;
};

/// The tags of a valid bundle that are seen. `variance` (px^2) is that of each coordinate of a corner whose covariance
/// is not known. Throws std::invalid_argument as estimatePose() does for corners.
std::vector<SeenTag> tagsOf(const Bundle& bundle, const std::vector<TagCorners>& seen, const CameraModel& camera,
                            double variance, double lens_variance);

/// All corners and planes of the tags with the uncertainty that the images and the lens leave. The layout is taken to
/// be exact.
Observation observationOf(const std::vector<SeenTag>& tags, const CameraModel& camera);

/// The one or two poses that explain the tags' corners best, the best one first; empty if there is no such pose in
/// front of the camera. Their covariances include the uncertainty of the layout and the lens errors that neighbouring
/// tags share.
std::vector<PoseRefinement> fitBundle(const std::vector<SeenTag>& tags, const CameraModel& camera);

/// One of the poses of a body, and the probability that it is right.
struct WeightedPose
{
  PoseRefinement fit;
  double probability;
};

/// The result for one or two poses, of which the best one comes first. Their errors are those of `observation`.
TagPoses posesOf(const std::vector<WeightedPose>& poses, const Observation& observation, const CameraModel& camera);

}  // namespace robot_vision
