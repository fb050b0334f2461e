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
  cv::Point2d center;    // px, projection of the ball's centre, which is not the centroid of the ball's region
};

/// Computes the position of a ball of `diameter` (m) from its outline, a closed polygon of pixels that belong to the
/// ball, as cv::findContours gives it with or without compression.
///
/// The rays that touch a ball form a circular cone, wherever the ball is in the image. The axis of the cone goes
/// through the ball's centre, and its half angle a gives the distance, radius / sin(a). The cone is fitted to the rays
/// of the outline by least median of squares over cones through three rays (Rousseeuw 1984), then by least squares with
/// Tukey's weights, so that half of the ball may be hidden. A ball of 20 px radius is then found within 2 % of its
/// distance, one of 8 px within a quarter. Points on the border of the image are ignored, because the ball may be cut
/// off there.
///
/// Returns nothing for fewer than 8 other points, or if no cone in front of the camera fits, for instance for a square
/// or a bar that is large enough to tell (40 px). Throws std::invalid_argument as validate(camera) does, for a diameter
/// that is not positive, and for points outside of the image.
std::optional<BallPosition> ballPosition(const CameraModel& camera, const std::vector<cv::Point>& outline,
                                         double diameter);

/// A region that may be the ball.
struct BallCandidate
{
  cv::Point2d center;      // px
  double area = 0.0;       // px^2
  double roundness = 0.0;  // part of its smallest enclosing circle that it fills, 0 to 1
};

/// Chooses the ball among the candidates whose roundness is at least `min_roundness` (0 to 1): the one nearest to the
/// expected position (px), or the largest if there is none. Returns its index, or nothing if no candidate is round
/// enough. Throws std::invalid_argument if `min_roundness` is out of range.
std::optional<std::size_t> chooseBall(const std::vector<BallCandidate>& candidates, double min_roundness,
                                      const std::optional<cv::Point2d>& expected = std::nullopt);

}  // namespace robot_vision
