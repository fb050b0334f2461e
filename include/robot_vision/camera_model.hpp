#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// A pinhole camera with the distortion that sensor_msgs/CameraInfo calls plumb_bob or rational_polynomial. Points are
/// in the optical frame of REP 103 (x right, y down, z forward, metres); pixels count from the centre of the top left
/// one, as everywhere in OpenCV.
struct CameraModel
{
  int width = 0;                       // px
  int height = 0;                      // px
  cv::Matx33d K = cv::Matx33d::eye();  // focal lengths and principal point, px
  std::vector<double> D;               // k1, k2, p1, p2, k3, k4, k5, k6: the first 0, 4, 5 or 8 of them

  /// Pixel position of a point in the optical frame; NaN when it is not in front of the camera (z <= 0).
  cv::Point2d project(const cv::Point3d& point) const;

  /// The ray (x, y, 1) in the optical frame that a pixel position sees; the inverse of project.
  cv::Point2d ray(const cv::Point2d& pixel) const;
};

/// Throws std::invalid_argument naming what no camera has, its value and the range: a size or a focal length that is
/// not positive, a number that is not finite, another count of distortion coefficients.
void validate(const CameraModel& camera);

/// The rays of all pixel centres of a camera, CV_32FC1 of its size, in two planes for loops that run over a row.
struct RayTable
{
  cv::Mat x;  // x / z in the optical frame
  cv::Mat y;  // y / z in the optical frame
};

/// Computes the table of rays: some 0.1 us per pixel, so once per camera.
RayTable rayTable(const CameraModel& camera);

}  // namespace robot_vision
