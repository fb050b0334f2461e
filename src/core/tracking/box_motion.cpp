#include "box_motion.hpp"

#include <algorithm>
#include <cmath>

#include "velocity.hpp"

namespace robot_vision
{
namespace
{

constexpr double kInitialGrowth = 0.5;  // sides/s: standard deviation of how fast a new box grows in width and height
constexpr double kMinSide = 1.0;        // px, to which a box may be predicted to shrink

double square(double value)
{
  return value * value;
}

double sideOf(const cv::Rect2d& box)
{
  return std::sqrt(box.width) * std::sqrt(box.height);
}

cv::Vec2d centerOf(const cv::Rect2d& box)
{
  return {box.x + 0.5 * box.width, box.y + 0.5 * box.height};
}

PairFilter started(const cv::Vec2d& value, double variance, double rate_variance)
{
  return {value, {0.0, 0.0}, variance, 0.0, rate_variance};
}

}  // namespace

void PairFilter::predict(double elapsed, double density)
{
  const double t = elapsed;
  value += t * rate;
  value_variance += 2.0 * t * covariance + t * t * rate_variance + density * t * t * t / 3.0;
  covariance += t * rate_variance + density * t * t / 2.0;
  rate_variance += density * t;
}

void PairFilter::correct(const cv::Vec2d& measured, double variance)
{
  const double sum = value_variance + variance;
  const cv::Vec2d innovation = measured - value;
  value += value_variance / sum * innovation;
  rate += covariance / sum * innovation;
  rate_variance -= covariance * covariance / sum;
  covariance *= variance / sum;
  value_variance *= variance / sum;
}

void PairFilter::scaleVariances(double scale)
{
  const double area = square(scale);
  value_variance *= area;
  covariance *= area;
  rate_variance *= area;
}

BoxMotion::BoxMotion(const cv::Rect2d& box, const BoxTrackerParams& params)
{
  const double side = sideOf(box), variance = varianceOf(box, params);
  center_ = started(centerOf(box), variance, square(params.initial_speed * side));
  size_ = started({box.width, box.height}, variance, square(kInitialGrowth * side));
}

void BoxMotion::predict(const Warp& warp, double elapsed, const BoxTrackerParams& params)
{
  const cv::Matx22d linear(warp(0, 0), warp(0, 1), warp(1, 0), warp(1, 1));
  const double scale = scaleOf(warp);
  const cv::Point2d center = warped(warp, {center_.value[0], center_.value[1]});
  center_.value = {center.x, center.y};
  center_.rate = linear * center_.rate;
  center_.scaleVariances(scale);
  const cv::Vec2d stretch(std::hypot(linear(0, 0), linear(1, 0)), std::hypot(linear(0, 1), linear(1, 1)));
  size_.value = size_.value.mul(stretch);
  size_.rate = size_.rate.mul(stretch);
  size_.scaleVariances(scale);

  const cv::Vec2d least(std::min(size_.value[0], kMinSide), std::min(size_.value[1], kMinSide));
  const double side = this->side();
  center_.predict(elapsed, square(params.acceleration * side));
  size_.predict(elapsed, square(params.growth * side));
  size_.value = {std::max(size_.value[0], least[0]), std::max(size_.value[1], least[1])};
}

void BoxMotion::correct(const cv::Rect2d& measured, double since_seen, const BoxTrackerParams& params)
{
  const double variance = varianceOf(measured, params);
  const cv::Vec2d least(std::min(measured.width, kMinSide), std::min(measured.height, kMinSide));
  const cv::Vec2d surprise = centerOf(measured) - center_.value;
  if (cv::norm(surprise) > params.gate * std::sqrt(center_.value_variance + variance) && since_seen > kMinInterval)
  {
    // It has bounced or started: the filter begins anew, with the mean velocity since it was seen.
    const cv::Vec2d velocity = center_.rate + surprise / since_seen;
    center_ = started(centerOf(measured), variance, square(params.initial_speed * sideOf(measured)));
    center_.rate = velocity;
  }
  else
  {
    center_.correct(centerOf(measured), variance);
  }
  size_.correct({measured.width, measured.height}, variance);
  size_.value = {std::max(size_.value[0], least[0]), std::max(size_.value[1], least[1])};
}

cv::Rect2d BoxMotion::box() const
{
  const cv::Vec2d corner = center_.value - 0.5 * size_.value;
  return {corner[0], corner[1], size_.value[0], size_.value[1]};
}

double BoxMotion::varianceOf(const cv::Rect2d& measured, const BoxTrackerParams& params)
{
  return square(params.measurement_noise * sideOf(measured));
}

double BoxMotion::side() const
{
  return std::sqrt(size_.value[0]) * std::sqrt(size_.value[1]);
}

}  // namespace robot_vision
