#include "robot_vision/camera_model.hpp"

#include <cmath>
#include <limits>

namespace robot_vision
{

namespace
{

struct Distorted
{
  cv::Point2d point;
  cv::Matx22d jacobian;
};

// The plumb_bob model and its derivative with respect to the undistorted point.
Distorted distort(const std::array<double, 5>& D, const cv::Point2d& p)
{
  const double x = p.x, y = p.y, r2 = x * x + y * y;
  const double k1 = D[0], k2 = D[1], p1 = D[2], p2 = D[3], k3 = D[4];
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3));  // d radial / d x = slope * x
  const double mixed = x * y * slope + 2.0 * (p1 * x + p2 * y);
  Distorted result;
  result.point = {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
                  y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  result.jacobian = {radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, mixed, mixed,
                     radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x};
  return result;
}

// Newton from a guess; quadratic convergence, so a handful of steps reaches the last bits.
cv::Point2d undistort(const std::array<double, 5>& D, const cv::Point2d& target, cv::Point2d guess)
{
  const int max_steps = 20;
  const double tolerance = 1e-14;
  for (int step = 0; step < max_steps; ++step)
  {
    const Distorted now = distort(D, guess);
    const cv::Point2d error = target - now.point;
    const cv::Matx22d& J = now.jacobian;
    const double det = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
    guess.x += (J(1, 1) * error.x - J(0, 1) * error.y) / det;
    guess.y += (J(0, 0) * error.y - J(1, 0) * error.x) / det;
    if (error.dot(error) < tolerance * tolerance) break;
  }
  return guess;
}

cv::Point2d normalised(const CameraModel& camera, const cv::Point2d& pixel)
{
  const double y = (pixel.y - camera.K(1, 2)) / camera.K(1, 1);
  return {(pixel.x - camera.K(0, 2) - camera.K(0, 1) * y) / camera.K(0, 0), y};
}

}  // namespace

cv::Point2d CameraModel::project(const cv::Point3d& point) const
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  if (!(point.z > 0.0)) return {nan, nan};
  const cv::Point2d p = distort(D, {point.x / point.z, point.y / point.z}).point;
  return {K(0, 0) * p.x + K(0, 1) * p.y + K(0, 2), K(1, 1) * p.y + K(1, 2)};
}

cv::Point2d CameraModel::ray(const cv::Point2d& pixel) const
{
  const cv::Point2d target = normalised(*this, pixel);
  return undistort(D, target, target);
}

RayTable rayTable(const CameraModel& camera)
{
  RayTable table{cv::Mat(camera.height, camera.width, CV_32FC1), cv::Mat(camera.height, camera.width, CV_32FC1)};
  for (int row = 0; row < camera.height; ++row)
  {
    float* xs = table.x.ptr<float>(row);
    float* ys = table.y.ptr<float>(row);
    cv::Point2d ray = camera.ray({0.0, static_cast<double>(row)});
    for (int column = 0; column < camera.width; ++column)
    {
      // The neighbour's ray is a close guess and saves most of the steps.
      ray = undistort(camera.D, normalised(camera, cv::Point2d(column, row)), ray);
      xs[column] = static_cast<float>(ray.x);
      ys[column] = static_cast<float>(ray.y);
    }
  }
  return table;
}

}  // namespace robot_vision
