#include "robot_vision/tags/pose/tag_pose.hpp"

#include <cmath>
#include <set>

#include "bundle_pose.hpp"
#include "pose_ambiguity.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{

namespace
{

const double kMaxShiftNoise = 1.0;  // m
const double kMaxTurnNoise = 0.5;   // rad; larger angles are not small, as the covariance assumes

bool isPose(const cv::Affine3d& pose)
{
  const double tolerance = 1e-6;
  const cv::Matx33d R = pose.rotation();
  return cv::norm(R * R.t() - cv::Matx33d::eye()) < tolerance && cv::determinant(R) > 0.0 &&
         std::isfinite(cv::norm(pose.translation()));
}

}  // namespace

Bundle singleTag(int id, double size)
{
  return {"tag_" + std::to_string(id), {{id, size, cv::Affine3d::Identity()}}};
}

void validate(const Bundle& bundle)
{
  const std::string of_bundle = " of bundle '" + bundle.name + "'";
  require(!bundle.tags.empty(), "number of tags" + of_bundle, 0, "at least 1");
  std::set<int> ids;
  for (const BundleTag& tag : bundle.tags)
  {
    const std::string of_tag = " of tag " + std::to_string(tag.id) + of_bundle;
    require(tag.id >= 0, "id of a tag" + of_bundle, tag.id, "at least 0");
    require(ids.insert(tag.id).second, "id of a tag" + of_bundle, std::to_string(tag.id) + " twice", "there once");
    require(tag.size > 0.0 && std::isfinite(tag.size), "size" + of_tag, tag.size, "above 0 (m)");
    require(isPose(tag.pose), "pose" + of_tag, "none", "a rotation and a finite translation");
    requireRange("shift_noise" + of_tag, tag.shift_noise, 0.0, kMaxShiftNoise);
    requireRange("turn_noise" + of_tag, tag.turn_noise, 0.0, kMaxTurnNoise);
  }
}

std::optional<TagPoses> estimatePose(const Bundle& bundle, const std::vector<TagCorners>& seen,
                                     const CameraModel& camera, double noise, double lens_noise)
{
  validate(bundle);
  validate(camera);
  requireRange("noise", noise, 0.001, 10.0);
  requireRange("lens_noise", lens_noise, 0.0, 10.0);
  const std::vector<SeenTag> tags = tagsOf(bundle, seen, camera, noise * noise, lens_noise * lens_noise);
  const std::vector<PoseRefinement> fits = fitBundle(tags, camera);
  if (fits.empty()) return std::nullopt;
  return posesOf(PoseAmbiguity().update(0.0, fits, 1.0), observationOf(tags, camera), camera);
}

}  // namespace robot_vision
