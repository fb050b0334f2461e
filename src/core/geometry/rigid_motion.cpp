#include "rigid_motion.hpp"

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxRotationError = 1e-3;  // largest element of R * R^T - I
constexpr double kMaxDistance = 1000.0;     // m

}  // namespace

bool isRotation(const cv::Matx33d& R)
{
  return cv::norm(R * R.t() - cv::Matx33d::eye(), cv::NORM_INF) < kMaxRotationError && cv::determinant(R) > 0.0;
}

void requireRigid(const cv::Affine3d& transform, const std::string& name)
{
  require(isRotation(transform.rotation()), name, "no rotation and translation", "that of a rigid body");
  for (const double value : transform.translation().val)
    requireRange(name, value, -kMaxDistance, kMaxDistance);
}

cv::Affine3d moved(const cv::Affine3d& pose, const cv::Vec6d& by)
{
  const cv::Affine3d turn(cv::Vec3d(by[3], by[4], by[5]));
  return {turn.rotation() * pose.rotation(), pose.translation() + cv::Vec3d(by[0], by[1], by[2])};
}

cv::Vec6d difference(const cv::Affine3d& from, const cv::Affine3d& to)
{
  const cv::Vec3d shift = to.translation() - from.translation();
  const cv::Vec3d turn = cv::Affine3d(to.rotation() * from.rotation().t()).rvec();
  return {shift[0], shift[1], shift[2], turn[0], turn[1], turn[2]};
}

cv::Matx33d crossMatrix(const cv::Vec3d& v)
{
  return {0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0};
}

cv::Matx66d atOrigin(const cv::Matx66d& covariance, const cv::Vec3d& to_origin)
{
  cv::Matx66d by_motion = cv::Matx66d::eye();  // a rotation shifts the other point by its cross product with the way
  const cv::Matx33d turn = crossMatrix(to_origin);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      by_motion(row, 3 + column) = -turn(row, column);
  return by_motion * covariance * by_motion.t();
}

}  // namespace robot_vision
