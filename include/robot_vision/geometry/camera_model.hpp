#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

/// Where a camera sees a point, and how that changes with the point.
struct Projection
{
  cv::Point2d pixel;
  cv::Matx23d jacobian;  // px/m
};

/// A pinhole camera with one of the distortions of sensor_msgs/CameraInfo, and that message's numbers. Points are in
/// the optical frame of REP 103 (x right, y down, z forward, metres); pixels count from the centre of the top left one,
/// as everywhere in OpenCV.
struct CameraModel
{
  int width = 0;                       // px
  int height = 0;                      // px
  cv::Matx33d K = cv::Matx33d::eye();  // focal lengths, skew and principal point, px
  std::vector<double> D;               // k1, k2, p1, p2, k3, k4, k5, k6: the first 0, 4, 5 or 8; equidistant: k1 to k4

  // plumb_bob, rational_polynomial: as cv::projectPoints, whichever of the two names; equidistant, fisheye: as
  // cv::fisheye; "", which drivers give to pictures that are not distorted: D is empty.
  std::string distortion_model = "plumb_bob";

  /// Pixel position of a point in the optical frame; NaN when it is not in front of the camera (z <= 0).
  cv::Point2d project(const cv::Point3d& point) const;

  /// The same, with the derivative with respect to the point.
  Projection projection(const cv::Point3d& point) const;

  /// The ray (x, y, 1) in the optical frame that a pixel position sees; the inverse of project. NaN if there is none.
  cv::Point2d ray(const cv::Point2d& pixel) const;
};

/// Whether a CameraInfo with this K is of a calibrated camera: others have zeros there. All else that is wrong with it
/// is an error, which validate() names.
bool isCalibrated(const cv::Matx33d& K);

/// Throws std::invalid_argument naming what no camera has, its value and the range: a size or a focal length that is
/// not positive, a number that is not finite or above a million, a K that is not of a pinhole, a model that is not
/// known, another count of distortion coefficients.
void validate(const CameraModel& camera);

/// The same for what a CameraInfo says of rectified images. Zeros, which are of a camera that nobody rectifies, pass.
void validateRectification(const cv::Matx33d& R, const cv::Matx34d& P);

/// The rays of all pixel centres of a camera, CV_32FC1 of its size, in two planes for loops that run over a row.
struct RayTable
{
  cv::Mat x;  // x / z in the optical frame
  cv::Mat y;  // y / z in the optical frame
};

/// Computes the table of rays: some 0.1 us per pixel, so once per camera.
RayTable rayTable(const CameraModel& camera);

}  // namespace robot_vision
