#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "robot_vision/depth/planes.hpp"

namespace robot_vision
{

/// The smallest rectangle around points of a plane, in the plane's own coordinates.
struct Footprint
{
  cv::Point2d middle;
  double length = 0.0;  // of the longer side
  double width = 0.0;
  double angle = 0.0;  // rad, of the longer side from the x axis towards y, above -pi/2 to pi/2
};

Footprint footprint(const std::vector<cv::Point2f>& points);

/// A table: its plane with coordinates along it, and what is above its hull.
class TableFrame
{
public:
  explicit TableFrame(const Plane& plane);

  /// A place in the camera's optical frame in that of the plane: x and y along it, z above it.
  cv::Vec3d local(const cv::Vec3d& place) const { return to_plane_ * place; }

  /// Whether a place in the plane's frame is above the hull, or beyond it by a margin at most.
  bool isAbove(const cv::Vec3d& place, double margin) const;

  const std::vector<cv::Point2f>& hull() const { return hull_; }

  /// Of the hull, m^2.
  double area() const;

  /// The pose of a frame with its x axis along the longer side of a rectangle, `height` above the middle of it.
  cv::Affine3d poseOf(const Footprint& rectangle, double height) const;

private:
  cv::Affine3d pose_;  // of the plane's frame in the camera's optical frame
  cv::Affine3d to_plane_;
  /// A side of the hull: what is inside is at most `distance` away from the frame's origin along `outwards`.
  struct Side
  {
    cv::Point2d outwards;  // unit vector
    double distance;       // m
  };

  std::vector<cv::Point2f> hull_;  // counter-clockwise
  std::vector<Side> sides_;        // none if the hull has no area
};

}  // namespace robot_vision
