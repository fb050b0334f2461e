#include "pose_step.hpp"

#include <cmath>
#include <opencv2/core/affine.hpp>

namespace robot_vision
{
namespace
{

constexpr double kMinWeight = 6.0;  // of what a step is made of
constexpr double kDamping = 0.02;   // of a step, against directions of which nothing is known
constexpr double kLeast = 1e-12;

}  // namespace

bool PoseStep::apply(ViewPose& pose)
{
  if (weight_ < kMinWeight) return false;
  for (int i = 0; i < 6; ++i)
    left_[i][i] += kDamping * (i < 3 ? spread_ : weight_) + kLeast;
  double step[6];
  if (!solve(step)) return false;
  pose.rotation = cv::Affine3d(cv::Vec3d(step[0], step[1], step[2]), cv::Vec3d()).rotation() * pose.rotation;
  pose.anchor += cv::Vec3d(step[3], step[4], step[5]);
  return true;
}

/// By the decomposition of Cholesky, which replaces the sums.
bool PoseStep::solve(double* step)
{
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j)
    {
      double sum = left_[i][j];
      for (int k = 0; k < j; ++k)
        sum -= left_[i][k] * left_[j][k];
      if (i == j && !(sum > 0.0)) return false;
      left_[i][j] = i == j ? std::sqrt(sum) : sum / left_[j][j];
    }
  for (int i = 0; i < 6; ++i)
  {
    step[i] = right_[i];
    for (int k = 0; k < i; ++k)
      step[i] -= left_[i][k] * step[k];
    step[i] /= left_[i][i];
  }
  for (int i = 5; i >= 0; --i)
  {
    for (int k = i + 1; k < 6; ++k)
      step[i] -= left_[k][i] * step[k];
    step[i] /= left_[i][i];
  }
  return true;
}

}  // namespace robot_vision
