#pragma once

#include <cmath>
#include <opencv2/core.hpp>

#include "robot_vision/common/range.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// The ray of a pixel position. Throws std::invalid_argument if the lens has none.
inline cv::Point2d rayThrough(const CameraModel& camera, const cv::Point2d& pixel)
{
  const cv::Point2d ray = camera.ray(pixel);
  require(std::isfinite(ray.x) && std::isfinite(ray.y), "a place in the region",
          "(" + toText(pixel.x) + ", " + toText(pixel.y) + ")", "where the lens of the camera has a ray");
  return ray;
}

}  // namespace robot_vision
