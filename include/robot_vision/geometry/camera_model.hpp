#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

/// The pixel position at which a camera sees a point, and its derivative with respect to the point.
struct Projection
{
  cv::Point2d pixel;
  cv::Matx23d jacobian;  // px/m
};

/// A pinhole camera with lens distortion, described by the fields of sensor_msgs/CameraInfo. Points are in the optical
/// frame of REP 103 (x right, y down, z forward, metres). Pixel positions count from the centre of the top left pixel,
/// as in OpenCV.
struct CameraModel
{
  int width = 0;                       // px
  int height = 0;                      // px
  cv::Matx33d K = cv::Matx33d::eye();  // focal lengths, skew and principal point, px

  // The first 0, 4, 5 or 8 of k1, k2, p1, p2, k3, k4, k5, k6; k1 to k4 of an equidistant lens.
  std::vector<double> D;

  // plumb_bob and rational_polynomial both mean the model of cv::projectPoints, equidistant and fisheye that of
  // cv::fisheye. Drivers whose images have no distortion leave the name and D empty.
  std::string distortion_model = "plumb_bob";

  /// The pixel position of a point in the optical frame, NaN if the point is not in front of the camera (z <= 0).
  cv::Point2d project(const cv::Point3d& point) const;

  /// project() with its derivative.
  Projection projection(const cv::Point3d& point) const;

  /// The inverse of project(): x and y of the ray (x, y, 1) in the optical frame that is seen at a pixel position, NaN
  /// if there is no such ray.
  cv::Point2d ray(const cv::Point2d& pixel) const;
};

bool operator==(const CameraModel& a, const CameraModel& b);

/// Whether K is that of a calibrated camera. Drivers publish zeros as long as a camera is not calibrated; any other
/// wrong K is an error that validate() reports.
bool isCalibrated(const cv::Matx33d& K);

/// Throws std::invalid_argument naming a field that no camera can have, its value and the range: a size or a focal
/// length that is not positive, a number that is not finite or beyond a million, a K that is not of a pinhole camera,
/// an unknown distortion model, or a wrong number of distortion coefficients.
void validate(const CameraModel& camera);

/// The same for the fields of a CameraInfo that describe rectified images. All zeros are valid: the camera's images are
/// not rectified then.
void validateRectification(const cv::Matx33d& R, const cv::Matx34d& P);

/// The rays through all pixel centres of a camera: two CV_32FC1 images of its size, so that loops can run along rows.
struct RayTable
{
  cv::Mat x;  // x / z in the optical frame
  cv::Mat y;  // y / z in the optical frame
};

/// Computes the table of rays. That takes some 0.1 us per pixel, so it should be done once per camera.
RayTable rayTable(const CameraModel& camera);

}  // namespace robot_vision
