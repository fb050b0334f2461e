#pragma once

#include <array>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// A pinhole camera with plumb_bob distortion. Points are in the optical frame of REP 103 (x right, y down, z forward,
/// metres); pixels count from the centre of the top left one, as everywhere in OpenCV.
struct CameraModel
{
  int width = 0;                              // px
  int height = 0;                             // px
  cv::Matx33d K = cv::Matx33d::eye();         // focal lengths and principal point, px
  std::array<double, 5> D = {0, 0, 0, 0, 0};  // k1, k2, p1, p2, k3

  /// Pixel position of a point in the optical frame; NaN when it is not in front of the camera (z <= 0).
  cv::Point2d project(const cv::Point3d& point) const;

  /// The ray (x, y, 1) in the optical frame that a pixel position sees; the inverse of project.
  cv::Point2d ray(const cv::Point2d& pixel) const;
};

/// The rays of all pixel centres of a camera, CV_32FC1 of its size, in two planes for loops that run over a row.
struct RayTable
{
  cv::Mat x;  // x / z in the optical frame
  cv::Mat y;  // y / z in the optical frame
};

/// Computes the table of rays: some 0.1 us per pixel, so once per camera.
RayTable rayTable(const CameraModel& camera);

}  // namespace robot_vision
