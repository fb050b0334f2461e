#include "robot_vision/geometry/camera_model.hpp"

#include <cmath>
#include <limits>

#include "distortion.hpp"
#include "rigid_motion.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/geometry/distortion_models.hpp"

namespace robot_vision
{

namespace
{

const double kNan = std::numeric_limits<double>::quiet_NaN();

constexpr int kMaxSide = 1 << 16;        // px
constexpr double kMaxCoefficient = 1e6;  // in K, D and P; with this focal length in px one sees hundredths of a degree

template <int n>
std::string listOf(const cv::Matx<double, 1, n>& row)
{
  std::vector<std::string> numbers;
  for (const double value : row.val)
    numbers.push_back(toText(value));
  return joined(numbers);
}

/// A pixel position on the plane z = 1, still distorted.
cv::Point2d normalized(const CameraModel& camera, const cv::Point2d& pixel)
{
  const double y = (pixel.y - camera.K(1, 2)) / camera.K(1, 1);
  return {(pixel.x - camera.K(0, 2) - camera.K(0, 1) * y) / camera.K(0, 0), y};
}

void validateDistortion(const std::string& model, std::size_t count)
{
  const std::string found = std::to_string(count) + " numbers", of_them = " of them (distortion_model " + model + ")";
  if (isEquidistant(model))
    require(count == 4, "D", found, "4" + of_them);
  else if (isPolynomial(model))
    require(count == 0 || count == 4 || count == 5 || count == 8, "D", found, "0, 4, 5 or 8" + of_them);
  else
    require(model.empty() && count == 0, "distortion_model", "'" + printable(model) + "'",
            "plumb_bob, rational_polynomial, equidistant or fisheye");
}

/// Throws std::invalid_argument naming a number that is not finite, or far larger than that of any camera.
void requirePlausible(const std::string& name, double value)
{
  requireFinite(name, value);
  requireRange(name, value, -kMaxCoefficient, kMaxCoefficient);
}

/// Checks an element on the diagonal of K, or of the left part of P.
void requireFocalLength(const std::string& name, double value)
{
  require(value > 0.0, name, value, "above 0 where it is a focal length");
}

}  // namespace

bool operator==(const CameraModel& a, const CameraModel& b)
{
  return a.width == b.width && a.height == b.height && a.K == b.K && a.D == b.D &&
         a.distortion_model == b.distortion_model;
}

bool isCalibrated(const cv::Matx33d& K)
{
  return K != cv::Matx33d::zeros();
}

void validate(const CameraModel& camera)
{
  require(camera.width >= 1, "width", camera.width, "at least 1");
  require(camera.height >= 1, "height", camera.height, "at least 1");
  requireRange("width", camera.width, 1, kMaxSide);
  requireRange("height", camera.height, 1, kMaxSide);
  require(isCalibrated(camera.K), "K", "0 everywhere", "that of a calibrated camera");
  for (const double value : camera.K.val)
    requirePlausible("K", value);
  for (const int axis : {0, 1})
    requireFocalLength("K", camera.K(axis, axis));
  require(camera.K(1, 0) == 0.0, "K[3]", camera.K(1, 0), "0");
  const cv::Matx13d last_row = camera.K.row(2);
  if (last_row != cv::Matx13d(0.0, 0.0, 1.0)) require(false, "the last row of K", listOf(last_row), "0, 0, 1");
  for (const double value : camera.D)
    requirePlausible("D", value);
  validateDistortion(camera.distortion_model, camera.D.size());
}

void validateRectification(const cv::Matx33d& R, const cv::Matx34d& P)
{
  for (const double value : R.val)
    requireFinite("R", value);
  require(isRotation(R) || R == cv::Matx33d::zeros(), "R", "no rotation", "a rotation matrix");
  for (const int row : {0, 1, 2})
    for (const int column : {0, 1, 2, 3})
      if (column < 3)
        requirePlausible("P", P(row, column));
      else
        requireFinite("P", P(row, column));  // a focal length times a baseline, of any size
  if (P == cv::Matx34d::zeros()) return;
  for (const int axis : {0, 1})
    requireFocalLength("P", P(axis, axis));
  const cv::Matx14d last_row = P.row(2);
  require(last_row == cv::Matx14d(0.0, 0.0, 1.0, 0.0), "the last row of P", listOf(last_row), "0, 0, 1, 0");
}

cv::Point2d CameraModel::project(const cv::Point3d& point) const
{
  return projection(point).pixel;
}

Projection CameraModel::projection(const cv::Point3d& point) const
{
  if (!(point.z > 0.0)) return {{kNan, kNan}, cv::Matx23d::all(kNan)};
  const double x = point.x / point.z, y = point.y / point.z, per_metre = 1.0 / point.z;
  const Distorted lens = Distortion(*this).distort({x, y});
  const cv::Matx22d pixels(K(0, 0), K(0, 1), 0.0, K(1, 1));
  const cv::Matx23d perspective(per_metre, 0.0, -x * per_metre, 0.0, per_metre, -y * per_metre);
  return {{K(0, 0) * lens.point.x + K(0, 1) * lens.point.y + K(0, 2), K(1, 1) * lens.point.y + K(1, 2)},
          pixels * lens.jacobian * perspective};
}

cv::Point2d CameraModel::ray(const cv::Point2d& pixel) const
{
  const cv::Point2d target = normalized(*this, pixel);
  return Undistortion(*this).undistort(target, target);
}

RayTable rayTable(const CameraModel& camera)
{
  RayTable table{cv::Mat(camera.height, camera.width, CV_32FC1), cv::Mat(camera.height, camera.width, CV_32FC1)};
  const Undistortion lens(camera);
  for (int row = 0; row < camera.height; ++row)
  {
    float* xs = table.x.ptr<float>(row);
    float* ys = table.y.ptr<float>(row);
    cv::Point2d ray = camera.ray({0.0, static_cast<double>(row)});
    for (int column = 0; column < camera.width; ++column)
    {
      // The ray of the neighbouring pixel is a good first guess, which saves most iterations.
      const cv::Point2d target = normalized(camera, cv::Point2d(column, row));
      const bool guided = !std::isnan(ray.x);
      ray = lens.undistort(target, guided ? ray : target);
      if (guided && std::isnan(ray.x)) ray = lens.undistort(target, target);
      xs[column] = static_cast<float>(ray.x);
      ys[column] = static_cast<float>(ray.y);
    }
  }
  return table;
}

}  // namespace robot_vision
