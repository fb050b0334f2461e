#include "robot_vision/camera_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "robot_vision/range.hpp"

namespace robot_vision
{

namespace
{

// The distortion of any camera, zeros where it has fewer coefficients.
using Coefficients = std::array<double, 8>;

Coefficients coefficients(const CameraModel& camera)
{
  Coefficients D = {};
  std::copy_n(camera.D.begin(), std::min(camera.D.size(), D.size()), D.begin());
  return D;
}

struct Distorted
{
  cv::Point2d point;
  cv::Matx22d jacobian;
};

// OpenCV's model (calib3d, cv::projectPoints) and its derivative with respect to the undistorted point.
Distorted distort(const Coefficients& D, const cv::Point2d& p)
{
  const double x = p.x, y = p.y, r2 = x * x + y * y;
  const double k1 = D[0], k2 = D[1], p1 = D[2], p2 = D[3], k3 = D[4], k4 = D[5], k5 = D[6], k6 = D[7];
  const double divisor = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double radial = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / divisor;
  const double growth = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3) - radial * (k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6));
  const double slope = 2.0 * growth / divisor;  // d radial / d x = slope * x
  const double mixed = x * y * slope + 2.0 * (p1 * x + p2 * y);
  Distorted result;
  result.point = {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
                  y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  result.jacobian = {radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, mixed, mixed,
                     radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x};
  return result;
}

// Newton from a guess; quadratic convergence, so a handful of steps reaches the last bits. NaN where the distortion,
// which is a model within the picture at best, has no such point.
cv::Point2d undistort(const Coefficients& D, const cv::Point2d& target, cv::Point2d guess)
{
  const int max_steps = 20;
  const double tolerance = 1e-14, good_enough = 1e-9;
  for (int step = 0; step < max_steps; ++step)
  {
    const Distorted now = distort(D, guess);
    const cv::Point2d error = target - now.point;
    const cv::Matx22d& J = now.jacobian;
    const double det = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
    guess.x += (J(1, 1) * error.x - J(0, 1) * error.y) / det;
    guess.y += (J(0, 0) * error.y - J(1, 0) * error.x) / det;
    if (error.dot(error) < tolerance * tolerance) return guess;
  }
  const cv::Point2d error = target - distort(D, guess).point;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return error.dot(error) < good_enough * good_enough ? guess : cv::Point2d(nan, nan);
}

cv::Point2d normalised(const CameraModel& camera, const cv::Point2d& pixel)
{
  const double y = (pixel.y - camera.K(1, 2)) / camera.K(1, 1);
  return {(pixel.x - camera.K(0, 2) - camera.K(0, 1) * y) / camera.K(0, 0), y};
}

}  // namespace

void validate(const CameraModel& camera)
{
  require(camera.width >= 1, "width", camera.width, "at least 1");
  require(camera.height >= 1, "height", camera.height, "at least 1");
  for (const double value : camera.K.val)
    require(std::isfinite(value), "K", value, "finite");
  for (const int axis : {0, 1})
    require(camera.K(axis, axis) > 0.0, "K", camera.K(axis, axis), "above 0 where it is a focal length");
  for (const double value : camera.D)
    require(std::isfinite(value), "D", value, "finite");
  const std::size_t count = camera.D.size();
  require(count == 0 || count == 4 || count == 5 || count == 8, "D", std::to_string(count) + " numbers",
          "0, 4, 5 or 8 of them");
}

cv::Point2d CameraModel::project(const cv::Point3d& point) const
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  if (!(point.z > 0.0)) return {nan, nan};
  const cv::Point2d p = distort(coefficients(*this), {point.x / point.z, point.y / point.z}).point;
  return {K(0, 0) * p.x + K(0, 1) * p.y + K(0, 2), K(1, 1) * p.y + K(1, 2)};
}

cv::Point2d CameraModel::ray(const cv::Point2d& pixel) const
{
  const cv::Point2d target = normalised(*this, pixel);
  return undistort(coefficients(*this), target, target);
}

RayTable rayTable(const CameraModel& camera)
{
  RayTable table{cv::Mat(camera.height, camera.width, CV_32FC1), cv::Mat(camera.height, camera.width, CV_32FC1)};
  const Coefficients D = coefficients(camera);
  for (int row = 0; row < camera.height; ++row)
  {
    float* xs = table.x.ptr<float>(row);
    float* ys = table.y.ptr<float>(row);
    cv::Point2d ray = camera.ray({0.0, static_cast<double>(row)});
    for (int column = 0; column < camera.width; ++column)
    {
      // The neighbour's ray is a close guess and saves most of the steps.
      const cv::Point2d target = normalised(camera, cv::Point2d(column, row));
      ray = undistort(D, target, std::isnan(ray.x) ? target : ray);
      xs[column] = static_cast<float>(ray.x);
      ys[column] = static_cast<float>(ray.y);
    }
  }
  return table;
}

}  // namespace robot_vision
