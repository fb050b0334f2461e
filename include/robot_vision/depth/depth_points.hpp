#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// Makes points of the depth images of one camera, whose rays it keeps. The points are in the camera's optical frame,
/// m, one for each pixel; x, y and z are NaN where there is no depth, and where the lens has no ray. Threads may share
/// a DepthPoints, because it never changes.
///
/// All functions reuse the last argument if it fits, and throw std::invalid_argument if `depth` is not of `encoding`
/// (see depth_image.hpp) or not of the camera's size.
class DepthPoints
{
public:
  /// Throws std::invalid_argument as validate() of the camera does.
  explicit DepthPoints(const CameraModel& camera);

  const CameraModel& camera() const { return camera_; }
  const RayTable& rays() const { return rays_; }

  /// Writes x, y and z: CV_32FC3.
  void points(const cv::Mat& depth, const std::string& encoding, cv::Mat& xyz) const;

  /// Writes x, y, z and 1, as PCL has its PointXYZ: CV_32FC4.
  void cloud(const cv::Mat& depth, const std::string& encoding, cv::Mat& xyz1) const;

  /// Writes x, y, z and the color of the same pixel of `bgr` (CV_8UC3), as the bits 0x00RRGGBB of a float: CV_32FC4.
  /// Throws also if `bgr` is of another type or size.
  void cloud(const cv::Mat& depth, const std::string& encoding, const cv::Mat& bgr, cv::Mat& xyzrgb) const;

private:
  template <class Write>
  void forRows(const cv::Mat& depth, const std::string& encoding, int type, cv::Mat& points, const Write& write) const;

  CameraModel camera_;
  RayTable rays_;
};

}  // namespace robot_vision
