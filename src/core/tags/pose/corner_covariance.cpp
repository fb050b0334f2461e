#include "corner_covariance.hpp"

#include <cmath>

namespace robot_vision
{

cv::Vec<double, 8> coordinatesOf(const std::array<cv::Point2d, 4>& corners)
{
  cv::Vec<double, 8> coordinates;
  for (int i = 0; i < 4; ++i)
  {
    coordinates[2 * i] = corners[static_cast<std::size_t>(i)].x;
    coordinates[2 * i + 1] = corners[static_cast<std::size_t>(i)].y;
  }
  return coordinates;
}

bool isCovariance(const CornerCovariance& matrix)
{
  const double tolerance = 1e-9, size = cv::norm(matrix);
  if (!std::isfinite(size) || cv::norm(matrix - matrix.t()) > tolerance * size) return false;
  bool is_definite = false;
  (matrix - tolerance * size * CornerCovariance::eye()).inv(cv::DECOMP_CHOLESKY, &is_definite);
  return is_definite;
}

CornerCovariance inverseOf(const CornerCovariance& matrix)
{
  const double scale = 1.0 / cv::norm(matrix);  // OpenCV takes a matrix of small numbers to be singular
  bool exists = false;
  const CornerCovariance inverse = scale * (scale * matrix).inv(cv::DECOMP_CHOLESKY, &exists);
  return exists && std::isfinite(cv::norm(inverse)) ? inverse : CornerCovariance::zeros();
}

CornerCovariance distortionCorrelation(const std::array<cv::Point2d, 4>& one, const std::array<cv::Point2d, 4>& other,
                                       const CameraModel& camera)
{
  CornerCovariance correlation = CornerCovariance::zeros();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
    {
      // Errors of a calibration shift points by amounts that change over about the width of the image: errors of the
      // focal lengths and the principal point move all of it, errors of the higher terms hardly more than its corners.
      const cv::Point2d between =
          (one[static_cast<std::size_t>(i)] - other[static_cast<std::size_t>(j)]) / camera.width;
      correlation(2 * i, 2 * j) = correlation(2 * i + 1, 2 * j + 1) = std::exp(-between.dot(between) / 2.0);
    }
  return correlation;
}

}  // namespace robot_vision
