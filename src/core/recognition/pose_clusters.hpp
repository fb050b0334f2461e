#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

namespace robot_vision
{

/// A pose that some votes are for.
struct VotedPose
{
  cv::Affine3d pose;
  double votes = 0.0;
  double share = 0.0;  // 0 to 1, of those that it could have
};

/// Puts poses together whose point `center` (m, in the object's frame) is less than `shift` (m) apart, and which are
/// turned by less than `turn` (rad) against each other: their means, with all votes and the largest share, the one with
/// most votes first.
std::vector<VotedPose> clusterPoses(std::vector<VotedPose> poses, const cv::Vec3d& center, double shift, double turn);

}  // namespace robot_vision
