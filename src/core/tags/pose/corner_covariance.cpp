#include "corner_covariance.hpp"

#include <cmath>

namespace robot_vision
{

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

}  // namespace robot_vision
