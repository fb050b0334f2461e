#pragma once

#include <opencv2/core.hpp>

#include "frame_warps.hpp"
#include "robot_vision/tracking/box_tracker.hpp"

namespace robot_vision
{

/// Two numbers that change at constant rates, disturbed by accelerations that are white noise, as a Kalman filter knows
/// them. Nothing distinguishes one number from the other, so that their covariances are the same, and none is between
/// them. The model is discretized in closed form for any time step (Bar-Shalom, Li, Kirubarajan: Estimation with
/// Applications to Tracking and Navigation, 6.2.2).
struct PairFilter
{
  cv::Vec2d value, rate;                                               // px, px/s
  double value_variance = 0.0, covariance = 0.0, rate_variance = 0.0;  // of each of the two, px^2, px^2/s, px^2/s^2

  /// `density` is the spectral density of the accelerations, px^2/s^3.
  void predict(double elapsed, double density);

  /// `variance` is that of each of the two numbers measured, px^2, above 0.
  void correct(const cv::Vec2d& measured, double variance);

  /// Applies what enlarges all lengths by `scale`, as far as it concerns the covariance.
  void scaleVariances(double scale);
};

/// The motion of a box: one filter of its centre, and one of its width and height. All noise is in proportion to the
/// box's side, the root of its area.
class BoxMotion
{
public:
  BoxMotion(const cv::Rect2d& box, const BoxTrackerParams& params);

  /// Moves the box with the camera, and then by its own motion. A rotation does not change its width and height.
  void predict(const Warp& warp, double elapsed, const BoxTrackerParams& params);

  /// Where the box was seen, `since_seen` s after it was seen before.
  void correct(const cv::Rect2d& measured, double since_seen, const BoxTrackerParams& params);

  /// Lets it neither grow nor shrink from now on, as nothing shows that it still does.
  void keepSize() { size_.rate = {0.0, 0.0}; }

  cv::Rect2d box() const;
  double centerVariance() const { return center_.value_variance; }  // px^2, of x and of y
  cv::Point2d velocity() const { return {center_.rate[0], center_.rate[1]}; }

  /// The variance of each number of a detection, px^2.
  static double varianceOf(const cv::Rect2d& measured, const BoxTrackerParams& params);

private:
  double side() const;

  PairFilter center_, size_;
};

}  // namespace robot_vision
