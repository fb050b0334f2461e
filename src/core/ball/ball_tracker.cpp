#include "robot_vision/ball/ball_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxFrameGap = 2.0;  // s, between two frames of one motion

double square(double value)
{
  return value * value;
}

}  // namespace

BallTracker::BallTracker(const BallTrackerParams& params) : params_(params)
{
  validate(params);
}

std::optional<BallState> BallTracker::update(double time_s, const std::optional<BallMeasurement>& measured)
{
  requireFinite("time_s", time_s);
  if (measured)
  {
    requireFinite("center.x", measured->center.x);
    requireFinite("center.y", measured->center.y);
    require(measured->radius >= 0.0 && std::isfinite(measured->radius), "radius", measured->radius, "at least 0 (px)");
  }
  const double gap = time_s - measured_;
  if (time_s < time_ || gap > longestGap(measured.has_value())) tracking_ = false;
  if (!tracking_ && !measured) return std::nullopt;

  bool found = false;
  if (tracking_)
  {
    advance(time_s);
    found = measured && correct(*measured);
    // A ball may not be predicted for longer, even if something else was measured.
    tracking_ = found || gap <= params_.max_prediction;
  }
  if (!tracking_)  // there is a measurement then
  {
    start(time_s, *measured);
    found = true;
  }
  if (found) measured_ = time_s;
  hidden_ = !found;
  return BallState{{state_[0], state_[1]}, {state_[2], state_[3]}, radius_, !found, covariance_};
}

std::optional<BallState> BallTracker::predict(double time_s) const
{
  return BallTracker(*this).update(time_s, std::nullopt);
}

std::optional<BallState> BallTracker::expected(double time_s) const
{
  BallTracker tracker(*this);
  tracker.params_.max_prediction = longestGap(true);
  return tracker.predict(time_s);
}

/// The time since the last measurement after which the ball is lost. One that was seen in the frame before is not, just
/// because frames are rare.
double BallTracker::longestGap(bool is_seen) const
{
  return is_seen && !hidden_ ? std::max(params_.max_prediction, kMaxFrameGap) : params_.max_prediction;
}

void BallTracker::start(double time_s, const BallMeasurement& measured)
{
  const double position = square(params_.measurement_noise), velocity = square(params_.initial_speed);
  tracking_ = true;
  time_ = time_s;
  state_ = {measured.center.x, measured.center.y, 0.0, 0.0};
  covariance_ = cv::Matx44d::diag({position, position, velocity, velocity});
  radius_ = measured.radius;
  radius_variance_ = position;
}

void BallTracker::advance(double time_s)
{
  const double t = time_s - time_, density = square(params_.process_noise);
  const double q11 = density * t * t * t / 3.0, q12 = density * t * t / 2.0, q22 = density * t;
  const cv::Matx44d transition(1, 0, t, 0,  //
                               0, 1, 0, t,  //
                               0, 0, 1, 0,  //
                               0, 0, 0, 1);
  const cv::Matx44d disturbance(q11, 0, q12, 0,  //
                                0, q11, 0, q12,  //
                                q12, 0, q22, 0,  //
                                0, q12, 0, q22);
  time_ = time_s;
  state_ = transition * state_;
  covariance_ = transition * covariance_ * transition.t() + disturbance;
  radius_variance_ += square(params_.radius_noise) * t;
}

bool BallTracker::correct(const BallMeasurement& measured)
{
  const double noise = square(params_.measurement_noise);
  const cv::Matx<double, 2, 4> observation(1, 0, 0, 0,  //
                                           0, 1, 0, 0);
  const cv::Vec2d innovation(measured.center.x - state_[0], measured.center.y - state_[1]);
  const cv::Matx22d innovation_covariance = observation * covariance_ * observation.t() + noise * cv::Matx22d::eye();
  const cv::Matx22d weight = innovation_covariance.inv();
  if (innovation.dot(weight * innovation) > square(params_.gate)) return false;

  const cv::Matx<double, 4, 2> gain = covariance_ * observation.t() * weight;
  // Joseph's form keeps the covariance symmetric and positive in spite of rounding.
  const cv::Matx44d rest = cv::Matx44d::eye() - gain * observation;
  state_ += gain * innovation;
  covariance_ = rest * covariance_ * rest.t() + noise * (gain * gain.t());

  const double radius_gain = radius_variance_ / (radius_variance_ + noise);
  radius_ += radius_gain * (measured.radius - radius_);
  radius_variance_ *= 1.0 - radius_gain;
  return true;
}

}  // namespace robot_vision
