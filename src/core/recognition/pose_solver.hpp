#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "core/geometry/rigid_motion.hpp"
#include "pose_equations.hpp"

namespace robot_vision
{

constexpr int kMinResiduals = 12;  // that a motion can follow from

/// How far a body may move, so that what residuals do not tell stays as it is.
struct MotionLimits
{
  double shift;   // m, standard deviation
  double turn;    // rad, likewise
  double radius;  // m, of the body
  int steps;      // at most
};

/// The step that makes the residuals smallest, as far as they are linear.
inline cv::Vec6d stepOf(const PoseEquations& equations, double damping, const MotionLimits& limits)
{
  cv::Matx66d damped = equations.information();
  for (int i = 0; i < 6; ++i)
  {
    const double deviation = i < 3 ? limits.shift : limits.turn;
    damped(i, i) = damped(i, i) * (1.0 + damping) + 1.0 / (deviation * deviation);
  }
  return damped.solve(equations.gradient(), cv::DECOMP_CHOLESKY);
}

/// The motion near `start` with the least cost, by the method of Levenberg and Marquardt. equationsAt(motion) sums up
/// the residuals.
template <class EquationsAt>
cv::Affine3d solveMotion(const cv::Affine3d& start, const MotionLimits& limits, const EquationsAt& equationsAt)
{
  constexpr double kMinStep = 0.00002;  // m, that is worth another one; also of a rotation, at the radius
  cv::Affine3d motion = start;
  PoseEquations now = equationsAt(motion);
  double damping = 1e-3;
  for (int step = 0; step < limits.steps && now.count() >= kMinResiduals; ++step)
  {
    const cv::Vec6d by = stepOf(now, damping, limits);
    const cv::Affine3d next_motion = moved(motion, by);
    const PoseEquations next = equationsAt(next_motion);
    const bool is_better = next.cost() < now.cost();
    damping *= is_better ? 0.1 : 10.0;
    if (!is_better) continue;
    motion = next_motion;
    now = next;
    const cv::Vec3d shift(by[0], by[1], by[2]), turn(by[3], by[4], by[5]);
    if (cv::norm(shift) + limits.radius * cv::norm(turn) < kMinStep) break;
  }
  return motion;
}

}  // namespace robot_vision
