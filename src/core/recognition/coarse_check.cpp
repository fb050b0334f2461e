#include "coarse_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pose_solver.hpp"

namespace robot_vision
{
namespace
{

constexpr int kSteps = 5;
constexpr double kTurn = 0.3;         // rad, standard deviation of a candidate
constexpr double kGate = 3.0;         // standard deviations of the noise
constexpr double kShapeError = 0.03;  // share of the diameter, by which few points are off after few steps
constexpr double kMinKnown = 0.3;     // share of the points that tell something of all of them
const std::vector<ContourPoint> kNoContours;

}  // namespace

CoarseFit CoarseCheck::check(const RecognitionFrame& frame, const ObjectShape& shape, const cv::Affine3d& pose)
{
  const MeshExtent& extent = shape.extent();
  const cv::Matx33d rotation = pose.rotation();
  const cv::Vec3d center = pose * extent.center;
  const SurfaceView& view = shape.viewFrom(-(rotation.t() * center));
  points_.clear();
  for (std::size_t i = 0; i < view.points.size(); ++i)
    points_.push_back({rotation * cv::Vec3d(view.points[i]), rotation * cv::Vec3d(view.normals[i])});
  const PoseResiduals residuals(frame, errors_, 1.0, 1.0);
  FitTolerance tolerance;
  tolerance.shift = 0.5 * search_ * extent.diameter;
  const MotionLimits limits{search_ * extent.diameter, kTurn, extent.radius, kSteps};
  const cv::Affine3d motion =
      solveMotion({cv::Matx33d::eye(), center}, limits,
                  [&](const cv::Affine3d& by)
                  {
                    PoseEquations equations;
                    residuals.add(points_, kNoContours, by.rotation(), by.translation(), tolerance, equations);
                    return equations;
                  });
  // What hides a part of the object can pull it away from where it is.
  const CoarseFit before = fitAt(residuals, {cv::Matx33d::eye(), center}, pose, extent);
  CoarseFit after = fitAt(residuals, motion, pose, extent);
  after.is_moved = true;
  return after.quality < before.quality ? before : after;
}

/// What the points tell of a pose that moves as this: the rotation since `first`, and where the mesh's center is.
CoarseFit CoarseCheck::fitAt(const PoseResiduals& residuals, const cv::Affine3d& motion, const cv::Affine3d& first,
                             const MeshExtent& extent) const
{
  CoarseFit fit;
  const cv::Matx33d turned = motion.rotation() * first.rotation();
  fit.pose = {turned, motion.translation() - turned * extent.center};
  const double gate =
      kGate * depthDeviation(std::max(motion.translation()[2], 0.0), errors_) + kShapeError * extent.diameter;
  int known = 0, agreeing = 0, pierced = 0;
  for (const SurfacePoint& point : points_)
  {
    const double distance = residuals.distanceBehind(motion.translation() + motion.rotation() * point.point);
    if (std::isnan(distance)) continue;
    ++known;
    agreeing += std::abs(distance) < gate ? 1 : 0;
    pierced += distance >= gate ? 1 : 0;
  }
  const double all = std::max<double>(1.0, static_cast<double>(points_.size()));
  fit.known = known / all;
  fit.quality = (agreeing - pierced) / std::max<double>(known, kMinKnown * all);
  return fit;
}

}  // namespace robot_vision
