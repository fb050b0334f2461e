#pragma once

#include <opencv2/core.hpp>
#include <optional>

namespace robot_vision
{

struct BallTrackerParams
{
  double process_noise = 2000.0;   // px/s^1.5, root of the spectral density of the acceleration, above 0 to 1e6
  double measurement_noise = 0.5;  // px, standard deviation of a measured centre's x and y, and radius, 0.01 to 100
  double radius_noise = 10.0;      // px/s^0.5, root of the spectral density of the radius' rate of change, 0 to 1e4
  double initial_speed = 1000.0;   // px/s, standard deviation of the velocity that a new ball may have, 0 to 1e6
  double max_prediction = 0.5;     // s without a measurement until the ball is lost: longer than a frame, 0 to 60
  double gate = 5.0;               // standard deviations from where it is expected to what is no longer it, 1 to 100
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const BallTrackerParams& params);

struct BallMeasurement
{
  cv::Point2d center;   // px
  double radius = 0.0;  // px
};

struct BallState
{
  cv::Point2d center;      // px
  cv::Point2d velocity;    // px/s; 0 in the first frame, when only its covariance says anything
  double radius = 0.0;     // px
  bool predicted = false;  // not measured at this time
  cv::Matx44d covariance;  // of x, y (px) and their rates (px/s)
};

/// Follows one ball in the picture: a Kalman filter with constant velocity, disturbed by white-noise acceleration in
/// continuous time, whose discretisation in closed form serves every time step (Bar-Shalom, Li, Kirubarajan: Estimation
/// with Applications to Tracking and Navigation, 6.2.2). The radius is filtered as a random walk.
class BallTracker
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit BallTracker(const BallTrackerParams& params = BallTrackerParams());

  /// Takes what was found in the frame of `time_s` (s, of any clock), or that nothing was. A measurement outside of the
  /// gate counts as nothing found. Returns the ball, predicted where it was not found, until it has not been measured
  /// for max_prediction seconds: then nothing, and the next measurement is a new ball. Time that goes backwards makes
  /// the tracker forget the ball. Throws std::invalid_argument for numbers that are not finite and a negative radius.
  std::optional<BallState> update(double time_s, const std::optional<BallMeasurement>& measured);

  /// What update(time_s) without a measurement would return.
  std::optional<BallState> predict(double time_s) const;

private:
  void start(double time_s, const BallMeasurement& measured);
  void advance(double time_s);
  bool correct(const BallMeasurement& measured);

  BallTrackerParams params_;
  bool tracking_ = false;
  double time_ = 0.0;      // s, of the state
  double measured_ = 0.0;  // s, of the last measurement
  cv::Vec4d state_;        // x, y, their rates
  cv::Matx44d covariance_;
  double radius_ = 0.0;
  double radius_variance_ = 0.0;
};

}  // namespace robot_vision
