#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "near_places.hpp"

namespace robot_vision
{

/// Points of surfaces and their normals.
struct OrientedPoints
{
  std::vector<cv::Vec3f> points;   // m
  std::vector<cv::Vec3f> normals;  // of length 1

  std::size_t size() const { return points.size(); }
};

/// Takes points that are at least a distance apart from those that it took before, or whose normals differ by more than
/// 45 degrees.
class PointThinning
{
public:
  /// `distance` (m) is above 0.
  void begin(double distance);

  /// Takes the point, or does not.
  void offer(const cv::Vec3f& point, const cv::Vec3f& normal);

  const OrientedPoints& taken() const { return taken_; }

private:
  double distance_ = 1.0;
  OrientedPoints taken_;
  NearPlaces near_{distance_};  // what was taken
};

}  // namespace robot_vision
