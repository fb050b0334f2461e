#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct BallTrackerParams
{
  double process_noise = 2000.0;
  double measurement_noise = 0.5;
  double radius_noise = 10.0;
  double initial_speed = 1000.0;
  double max_prediction = 0.5;
  double gate = 5.0;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("process_noise", &BallTrackerParams::process_noise, Above{0, 1e6, " and up to "}, "px/s^1.5",
          "how fast the ball accelerates: root of the spectral density of the acceleration");
    visit("measurement_noise", &BallTrackerParams::measurement_noise, Range{0.01, 100}, "px",
          "error of a centre seen: standard deviation of its x and y, and of the radius");
    visit("radius_noise", &BallTrackerParams::radius_noise, Range{0, 1e4}, "px/s^0.5",
          "how fast the radius changes: root of the spectral density of its rate of change");
    visit("initial_speed", &BallTrackerParams::initial_speed, Range{0, 1e6}, "px/s",
          "standard deviation of the velocity that a new ball may have");
    visit("max_prediction", &BallTrackerParams::max_prediction, Range{0, 60}, "s",
          "longest time that the ball may be hidden until it is lost; 0: it is lost at once");
    visit("gate", &BallTrackerParams::gate, Range{1, 100}, "",
          "standard deviations from where the ball is expected to what is no longer it");
  }
};

struct BallMeasurement
{
  cv::Point2d center;   // px
  double radius = 0.0;  // px
};

struct BallState
{
  cv::Point2d center;      // px
  cv::Point2d velocity;    // px/s; 0 in the first frame, in which only the covariance is meaningful
  double radius = 0.0;     // px
  bool predicted = false;  // whether there was no measurement at this time
  cv::Matx44d covariance;  // of x, y (px) and their rates (px/s)
};

/// Tracks one ball in the image by a Kalman filter with constant velocity and white-noise acceleration in continuous
/// time. The model is discretized in closed form for any time step (Bar-Shalom, Li, Kirubarajan: Estimation with
/// Applications to Tracking and Navigation, 6.2.2). The radius is filtered as a random walk.
class BallTracker
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit BallTracker(const BallTrackerParams& params = BallTrackerParams());

  /// Updates the track with the measurement of the frame at `time_s` (s, of any clock), or with none. A measurement
  /// outside of the gate counts as none. Returns the state of the ball, which is predicted if there is no measurement.
  /// After max_prediction seconds without one the ball is lost: nothing is returned, and the next measurement begins a
  /// new ball, as one outside of the gate does then. So does any that is more than max_prediction, and more than 2 s,
  /// later than the frame before. A time that goes backwards makes the tracker forget the ball. Throws
  /// std::invalid_argument for numbers that are not finite, and for a negative radius.
  std::optional<BallState> update(double time_s, const std::optional<BallMeasurement>& measured);

  /// The state that update(time_s) without a measurement would return.
  std::optional<BallState> predict(double time_s) const;

  /// What update() compares a measurement at `time_s` with; nothing if that would begin a new ball wherever it is. A
  /// ball that was seen in the frame before is expected for 2 s, even if max_prediction is less.
  std::optional<BallState> expected(double time_s) const;

private:
  void start(double time_s, const BallMeasurement& measured);
  void advance(double time_s);
  bool correct(const BallMeasurement& measured);
  double longestGap(bool is_seen) const;

  BallTrackerParams params_;
  bool tracking_ = false;
  double time_ = 0.0;      // s, time of the state
  double measured_ = 0.0;  // s, time of the last measurement
  bool hidden_ = false;    // since then
  cv::Vec4d state_;        // x, y and their rates
  cv::Matx44d covariance_;
  double radius_ = 0.0;
  double radius_variance_ = 0.0;
};

}  // namespace robot_vision
