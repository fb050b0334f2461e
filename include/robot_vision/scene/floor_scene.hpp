#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// A floor with an image on it, drawn as the synthetic Scene draws its own floor: by the exact ray of every pixel, with
/// the lens's distortion. The world has x forward, y left, z up and its origin on the floor. All methods are const and
/// use no scratch memory, so threads may share one object.
class FloorScene
{
public:
  /// `floor_bgr` (CV_8UC3, copied) is centred on the origin, its top edge forward and its left edge left; `size` is its
  /// width and height in metres. The rest of the floor has the colour `around`. Throws std::invalid_argument if the
  /// image, its size or the camera is not valid.
  FloorScene(const cv::Mat& floor_bgr, const cv::Size2d& size, const CameraModel& camera, const cv::Scalar& around);
  ~FloorScene();

  /// Draws what the camera sees from a pose of its optical frame in the world, as CV_8UC3 BGR. The horizon must be out
  /// of view: what is above it is drawn as floor, too.
  void render(const cv::Affine3d& camera_in_world, cv::Mat& bgr) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace robot_vision
