#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "robot_vision/geometry/camera_model.hpp"

namespace robot_vision
{

struct BallPosition
{
  cv::Point3d position;  // m, centre of the ball in the camera's optical frame
  cv::Point2d center;    // px, where the camera sees that point: not the centroid of the ball's region
};

/// The position of a ball of `diameter` (m) from its outline, a closed polygon of pixels that belong to the ball, as
/// cv::findContours gives it with or without its compression. The rays that touch a ball form a circular cone: its axis
/// leads to the ball's centre and its half angle a to the distance, radius / sin(a), wherever the ball is in the
/// picture. The cone is fitted to the outline's rays: least median of squares over cones through three of them
/// (Rousseeuw 1984), then least squares with Tukey's weights, so that half of a ball may be hidden: one of 20 px radius
/// is then found within 2 % of its distance, one of 8 px within a quarter. Outline on the picture's border is left out,
/// since it may be a cut. Nothing is returned for fewer than 8 other points, and for points that no cone in front of
/// the camera fits: those of a square or of a bar, if it is large enough to tell (40 px).
/// Throws std::invalid_argument as validate(camera) does, and for a diameter that is not positive.
std::optional<BallPosition> ballPosition(const CameraModel& camera, const std::vector<cv::Point>& outline,
                                         double diameter);

/// A region that may be the ball.
struct BallCandidate
{
  cv::Point2d center;      // px
  double area = 0.0;       // px^2
  double roundness = 0.0;  // part of the smallest circle around it that it fills, 0 to 1
};

/// Index of the ball: of those candidates that are at least as round as `min_roundness` (0 to 1), the one nearest to
/// where it is expected (px), or else the largest. Nothing if none is round enough.
/// Throws std::invalid_argument for a `min_roundness` out of range.
std::optional<std::size_t> chooseBall(const std::vector<BallCandidate>& candidates, double min_roundness,
                                      const std::optional<cv::Point2d>& expected = std::nullopt);

}  // namespace robot_vision
