#include "lens_error.hpp"

#include <cmath>

namespace robot_vision
{

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

CornerCovariance lensError(const std::array<cv::Point2d, 4>& corners, double variance, const CameraModel& camera)
{
  return variance * distortionCorrelation(corners, corners, camera);
}

}  // namespace robot_vision
