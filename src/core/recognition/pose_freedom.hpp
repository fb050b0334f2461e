#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <optional>

#include "rendered_region.hpp"
#include "robot_vision/recognition/object_shape.hpp"

namespace robot_vision
{

/// The covariance of a pose of a body of this radius (m), from the information of its motions, which may be singular:
/// what is not known at all has the variance of a rotation by any angle, or of a shift by two radii.
cv::Matx66d covarianceOf(const cv::Matx66d& information, double radius);

/// What the covariance of a body's motions is if it may be rotated by any angle about an axis, that is in the camera's
/// optical frame; the body's origin is at `center`.
cv::Matx66d withFreeAxis(const cv::Matx66d& covariance, const FreeAxis& axis, const cv::Vec3d& center);

/// Whether an object looks the same when it is turned about its least certain axis, and that axis, in the camera's
/// optical frame. An object that is round but for the facets of its mesh does: each of them looks certain, and is not.
class FreedomCheck
{
public:
  /// `deviation` (m) is by how much depths may differ; colors count if `texture`.
  std::optional<FreeAxis> find(const ObjectShape& shape, const cv::Affine3d& pose, const cv::Matx66d& covariance,
                               const cv::Matx33d& K, const cv::Size& image, double deviation, bool texture);

private:
  bool isFree(const ObjectShape& shape, const FreeAxis& axis, double deviation, const RenderParts& parts);
  bool looksAlike(const MeshView& a, const MeshView& b, double deviation) const;

  RenderedRegion region_;
  MeshView turned_;
};

}  // namespace robot_vision
