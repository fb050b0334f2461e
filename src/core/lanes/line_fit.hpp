#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "line_search.hpp"
#include "robot_vision/lanes/ground_view.hpp"

namespace robot_vision::lanes
{

/// A parabola on the floor: y = c[0] + c[1] x + c[2] x^2 (m) between two x.
struct LineFit
{
  double y(double x) const { return c[0] + x * (c[1] + x * c[2]); }
  double slope(double x) const { return c[1] + 2.0 * c[2] * x; }
  double length() const { return to - from; }

  cv::Vec3d c;
  double from = 0.0, to = 0.0;      // m, x of its first and last place
  double confidence = 0.0;          // as LaneDetector has it
  std::vector<cv::Point2d> places;  // m, of the middles that it fits, at most kMaxPlaces
};

constexpr std::size_t kMaxPlaces = 600;  // of a line, evenly chosen: what is left out would tell no more

/// The parabola that fits most of the middles in a view from above, by RANSAC and then least squares. None if there is
/// no line that is long, straight and certain enough.
std::optional<LineFit> fitLine(const Places& middles, const GroundView& view, const LaneParams& params);

}  // namespace robot_vision::lanes
