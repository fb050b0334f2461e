#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// A floor with a picture on it, drawn as the synthetic Scene draws its own: by exact rays, distortion included. The
/// world has x forward, y left, z up and its origin on the floor. Const and without scratch memory: threads may share
/// one.
class FloorScene
{
public:
  /// `floor_bgr` (CV_8UC3, copied) lies around the origin, its top forward and its left side left; `size` (m) is its
  /// width and height. All around it the floor has the colour `around`. Throws std::invalid_argument if the picture,
  /// its size or the camera is none.
  FloorScene(const cv::Mat& floor_bgr, const cv::Size2d& size, const CameraModel& camera, const cv::Scalar& around);
  ~FloorScene();
  FloorScene(FloorScene&&) noexcept;
  FloorScene& operator=(FloorScene&&) noexcept;

  /// What the camera sees from a pose of its optical frame in the world, CV_8UC3 BGR. It must not see the horizon: what
  /// is above it is floor, too.
  void render(const cv::Affine3d& camera_in_world, cv::Mat& bgr) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace robot_vision
