#include "lens_error.hpp"

#include <cmath>

namespace robot_vision
{

CornerCovariance distortionCorrelation(const std::array<cv::Point2d, 4>& one, const std::array<cv::Point2d, 4>& other,
                                       const CameraModel& camera)
{
  CornerCovariance likeness = CornerCovariance::zeros();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
    {
      // Wrong numbers of a lens shift what is seen by amounts that change over about the width of the picture: focal
      // lengths and the middle move all of it, and the higher terms hardly anything but its corners.
      const cv::Point2d between =
          (one[static_cast<std::size_t>(i)] - other[static_cast<std::size_t>(j)]) / camera.width;
      likeness(2 * i, 2 * j) = likeness(2 * i + 1, 2 * j + 1) = std::exp(-between.dot(between) / 2.0);
    }
  return likeness;
}

CornerCovariance lensError(const std::array<cv::Point2d, 4>& corners, double variance, const CameraModel& camera)
{
  return variance * distortionCorrelation(corners, corners, camera);
}

}  // namespace robot_vision
