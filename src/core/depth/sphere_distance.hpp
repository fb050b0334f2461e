#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "region_samples.hpp"
#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

/// How a camera sees a sphere.
struct SphereView
{
  cv::Vec3d axis;       // unit vector in the optical frame, to the middle of the sphere
  double radius = 0.0;  // rad, between the axis and the rim
};

/// The view of a sphere that this circle encloses in the image, px. Throws std::invalid_argument if the lens has no
/// rays there, or the sphere is too large.
SphereView sphereView(const CameraModel& camera, const cv::Point2d& center, double radius);

constexpr std::size_t kMaxSphereSamples = 300;  // that are asked: the ray of each takes time

/// The distance (m) of the middle of a sphere that is seen so: the median of what samples within its rim say. Empty if
/// there is none.
std::optional<double> sphereDistance(const std::vector<RegionSample>& samples, const CameraModel& camera,
                                     const SphereView& view);

}  // namespace robot_vision
