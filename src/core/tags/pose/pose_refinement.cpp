#include "pose_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/rigid_motion.hpp"
#include "corner_covariance.hpp"

namespace robot_vision
{

namespace
{

const double kInfinity = std::numeric_limits<double>::infinity();

struct Linearised
{
  cv::Matx66d information = cv::Matx66d::zeros();
  cv::Vec6d gradient;
  double cost = 0.0;
};

using Corners = std::array<cv::Point2d, 4>;
using Residuals = cv::Vec<double, 8>;

/// Sets the rows d pixel / d (shift, rotation) of a point. A rotation moves the point by the cross product with
/// `lever`, the vector to it from the frame's origin.
void setRows(MotionJacobian& jacobian, int first, const cv::Matx23d& by_point, const cv::Vec3d& lever)
{
  const cv::Matx23d by_rotation = -by_point * crossMatrix(lever);
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column)
    {
      jacobian(first + row, column) = by_point(row, column);
      jacobian(first + row, column + 3) = by_rotation(row, column);
    }
}

/// Projects the points to `pixels` and returns the derivatives by the pose.
MotionJacobian project(const std::array<cv::Point3d, 4>& points, const CameraModel& camera, const cv::Affine3d& pose,
                       Corners& pixels)
{
  MotionJacobian J;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const cv::Vec3d lever = pose.rotation() * cv::Vec3d(points[i]);
    const Projection seen = camera.projection(cv::Point3d(lever + pose.translation()));
    setRows(J, 2 * static_cast<int>(i), seen.jacobian, lever);
    pixels[i] = seen.pixel;
  }
  return J;
}

/// The inverse depth of a plane that moves with a pose, and its derivatives by the pose.
struct PredictedPlane
{
  cv::Vec3d inverse_depth;
  PlaneJacobian jacobian;
};

PredictedPlane predict(const SeenPlane& plane, const cv::Affine3d& pose)
{
  // With the normal n and a point p of the plane, a ray r has the depth (n . p) / (n . r), so a, b and c are n / (n .
  // p).
  const cv::Vec3d n = pose.rotation() * plane.normal;
  const double distance = n.dot(pose * plane.point);
  const cv::Vec3d by_turn = n.cross(pose.translation()) * (1.0 / (distance * distance));
  PredictedPlane predicted{n * (1.0 / distance), PlaneJacobian()};
  const cv::Matx33d shift = n * n.t() * (-1.0 / (distance * distance));
  const cv::Matx33d turn = crossMatrix(n) * (-1.0 / distance) - n * by_turn.t();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
    {
      predicted.jacobian(row, column) = shift(row, column);
      predicted.jacobian(row, column + 3) = turn(row, column);
    }
  return predicted;
}

/// The inverse of a covariance, scaled because OpenCV takes a matrix of small numbers to be singular.
cv::Matx33d inverseOf(const cv::Matx33d& covariance)
{
  const double scale = 1.0 / cv::norm(covariance);
  return scale * (scale * covariance).inv(cv::DECOMP_CHOLESKY);
}

void addPlane(const SeenPlane& plane, const cv::Affine3d& pose, Linearised& sum)
{
  const PredictedPlane predicted = predict(plane, pose);
  const cv::Vec3d residuals = plane.inverse_depth - predicted.inverse_depth;
  const cv::Matx33d information = inverseOf(plane.covariance);
  const cv::Matx<double, 6, 3> weighted = predicted.jacobian.t() * information;
  sum.information += weighted * predicted.jacobian;
  sum.gradient += weighted * residuals;
  sum.cost += residuals.dot(information * residuals);
}

Linearised linearise(const Observation& observation, const CameraModel& camera, const cv::Affine3d& pose)
{
  Linearised sum;
  for (const SeenSquare& square : observation)
  {
    Corners pixels;
    const MotionJacobian J = project(square.points, camera, pose, pixels);
    const Residuals residuals = coordinatesOf(square.pixels) - coordinatesOf(pixels);
    const cv::Matx<double, 6, 8> weighted = J.t() * square.information;
    sum.information += weighted * J;
    sum.gradient += weighted * residuals;
    sum.cost += residuals.dot(square.information * residuals);
    if (square.plane) addPlane(*square.plane, pose, sum);
  }
  if (std::isnan(sum.cost)) sum.cost = kInfinity;
  return sum;
}

/// Computes the inverse; returns false if there is none.
bool invert(cv::Matx66d information, cv::Matx66d& covariance)
{
  // To first order, the tilt of a tag seen from the front does not show at all. So it gets a standard deviation of 1
  // rad.
  for (int i = 3; i < 6; ++i)
    information(i, i) += 1.0;
  // Large distances in metres and angles in radians differ too much in size to be inverted without scaling.
  cv::Matx66d scale = cv::Matx66d::zeros();
  for (int i = 0; i < 6; ++i)
  {
    if (!(information(i, i) > 0.0)) return false;
    scale(i, i) = 1.0 / std::sqrt(information(i, i));
  }
  bool exists = false;
  covariance = scale * (scale * information * scale).inv(cv::DECOMP_CHOLESKY, &exists) * scale;
  return exists && std::isfinite(cv::norm(covariance));
}

}  // namespace

MotionJacobian motionJacobian(const std::array<cv::Point3d, 4>& points, const CameraModel& camera,
                              const cv::Affine3d& pose)
{
  Corners pixels;
  return project(points, camera, pose, pixels);
}

PlaneJacobian planeJacobian(const SeenPlane& plane, const cv::Affine3d& pose)
{
  return predict(plane, pose).jacobian;
}

Observation cornersOnly(Observation observation)
{
  for (SeenSquare& square : observation)
    square.plane.reset();
  return observation;
}

double planeDistance(const SeenPlane& plane, const PoseRefinement& fit)
{
  const PredictedPlane predicted = predict(plane, fit.pose);
  const cv::Vec3d residuals = plane.inverse_depth - predicted.inverse_depth;
  const cv::Matx33d expected = plane.covariance + predicted.jacobian * fit.covariance * predicted.jacobian.t();
  const cv::Matx33d information = inverseOf(expected);
  if (!(information(0, 0) > 0.0)) return std::numeric_limits<double>::infinity();  // it could not be inverted
  return residuals.dot(information * residuals);
}

PoseRefinement fitPose(const Observation& observation, const CameraModel& camera, const cv::Affine3d& start)
{
  const int max_steps = 50;
  const double min_gain = 1e-9;  // of the cost; far below the effect of noise
  cv::Affine3d pose = start;
  Linearised now = linearise(observation, camera, pose);
  double damping = 1e-4;
  for (int step = 0; step < max_steps && std::isfinite(now.cost); ++step)
  {
    cv::Matx66d damped = now.information;
    for (int i = 0; i < 6; ++i)
      damped(i, i) *= 1.0 + damping;
    const cv::Vec6d by = damped.solve(now.gradient, cv::DECOMP_CHOLESKY);
    if (by.dot(now.gradient) < min_gain) break;
    const cv::Affine3d next_pose = moved(pose, by);
    const Linearised next = linearise(observation, camera, next_pose);
    const bool better = next.cost < now.cost;
    damping *= better ? 0.1 : 10.0;
    if (!better) continue;
    pose = next_pose;
    now = next;
  }
  const auto planes = std::count_if(observation.begin(), observation.end(),
                                    [](const SeenSquare& square) { return square.plane.has_value(); });
  PoseRefinement fit{pose, cv::Matx66d(), now.cost, static_cast<int>(planes)};
  if (!invert(now.information, fit.covariance)) fit.cost = kInfinity;
  return fit;
}

double costOf(const Observation& observation, const CameraModel& camera, const cv::Affine3d& pose)
{
  double cost = 0.0;
  for (const SeenSquare& square : observation)
  {
    Corners pixels;
    std::transform(square.points.begin(), square.points.end(), pixels.begin(),
                   [&](const cv::Point3d& point) { return camera.project(pose * point); });
    const Residuals residuals = coordinatesOf(square.pixels) - coordinatesOf(pixels);
    cost += residuals.dot(square.information * residuals);
    if (!square.plane) continue;
    Linearised of_plane;
    addPlane(*square.plane, pose, of_plane);
    cost += of_plane.cost;
  }
  return std::isnan(cost) ? kInfinity : cost;
}

double errorOf(const Observation& observation, const CameraModel& camera, const cv::Affine3d& pose)
{
  Observation unit = cornersOnly(observation);
  for (SeenSquare& square : unit)
    square.information = CornerCovariance::eye();
  return std::sqrt(costOf(unit, camera, pose) / (4.0 * static_cast<double>(unit.size())));
}

}  // namespace robot_vision
