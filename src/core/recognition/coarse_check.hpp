#pragma once

#include <vector>

#include "pose_fit.hpp"
#include "robot_vision/recognition/object_shape.hpp"

namespace robot_vision
{

/// What few points say of a pose.
struct CoarseFit
{
  cv::Affine3d pose;      // that of the candidate, or one near it in which they agree better
  bool is_moved = false;  // whether it is another one
  double quality = 0.0;   // up to 1, if all of them agree; below 0 if more contradict
  double known = 0.0;     // share of them where a depth was measured
};

/// Compares a candidate with the depths of a frame at some hundred points of its surface, in some microseconds.
class CoarseCheck
{
public:
  CoarseCheck(const DepthErrorParams& errors, double search) : errors_(errors), search_(search) {}

  CoarseFit check(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Affine3d& pose);

private:
  CoarseFit fitAt(const PoseResiduals& residuals, const cv::Affine3d& motion, const cv::Affine3d& first,
                  const MeshExtent& extent) const;

  DepthErrorParams errors_;
  double search_;  // share of the diameter
  std::vector<SurfacePoint> points_;
};

}  // namespace robot_vision
