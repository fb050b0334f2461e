#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "robot_vision/meshes/mesh.hpp"

// Surfaces made by formulas, all in m. Each is closed, and has normals and colors.
namespace robot_vision::samples
{

/// A part of the profile of what a lathe makes: points (radius, height), the surface being smooth in between.
struct Band
{
  std::vector<cv::Vec2d> points;
  cv::Vec3b color;  // BGR
};

/// The body that is made by turning a profile about z. Each band begins where the one before ends, with an edge. The
/// profile begins and ends on the axis, or is a loop; its outside is to the right of who walks along it.
Mesh lathe(const std::vector<Band>& profile, int segments);

/// A tube around a path in the plane y = 0, as an ellipse of these half sizes in that plane and across it, with ends.
Mesh tube(const std::vector<cv::Vec3d>& path, const cv::Vec2d& half_sizes, int segments, const cv::Vec3b& color);

/// A prism: a polygon in the plane of x and y, counter-clockwise, from z = low to z = high. All its faces are flat.
Mesh prism(const std::vector<cv::Point2d>& polygon, double low, double high, const cv::Vec3b& color);

/// A body by its distances: `distance` of a point is negative inside, and changes by no more than the way. `cell` is
/// the length of the triangles' sides. The body must be within the box.
Mesh solid(const std::function<double(const cv::Vec3d&)>& distance,
           const std::function<cv::Vec3b(const cv::Vec3d&)>& color, const cv::Vec3d& low, const cv::Vec3d& high,
           double cell);

/// Adds another body, which may reach into the first one.
void add(Mesh& mesh, const Mesh& other);

}  // namespace robot_vision::samples
