#include "corner_filter.hpp"

#include <algorithm>
#include <cmath>

#include "corner_covariance.hpp"

namespace robot_vision
{

namespace
{

// Standard deviations of the models; the first one is that of a tag at rest.
const std::array<double, 5> kAccelerations = {0.0, 20.0, 150.0, 1200.0, 10000.0};  // px/s^2
// px/s, of a tag that is seen for the first time. If all models began as fast as the last one, a slow tag would be
// taken to be at rest.
const std::array<double, 5> kInitialSpeeds = {0.0, 1.0, 10.0, 100.0, 1000.0};
const double kModelChange = 0.02;      // probability that another model holds from the next frame on
const double kMinRestGain = 1.0 / 10;  // limits the memory of a tag at rest to some 20 frames
const double kMaxInnovation = 5.0;     // standard deviations; a larger one cannot be explained by motion
const double kStateSize = 8.0;

}  // namespace

CornerFilter::CornerFilter(const Corners& seen, double variance)
{
  for (std::size_t i = 0; i < kModels; ++i)
  {
    const cv::Matx22d moving(variance, 0.0, 0.0, kInitialSpeeds[i] * kInitialSpeeds[i]);
    models_[i] = {coordinatesOf(seen), State::all(0.0), moving, 1.0 / kModels, 1.0};
  }
}

void CornerFilter::update(double elapsed, const Corners& seen, double variance)
{
  mix();
  const State measured = coordinatesOf(seen);
  for (std::size_t i = 0; i < kModels; ++i)
    predict(models_[i], elapsed, kAccelerations[i]);
  if (squaredInnovation(models_.back(), measured, variance) > kMaxInnovation * kMaxInnovation)
  {
    *this = CornerFilter(seen, variance);
    return;
  }
  change_ = variance * squaredInnovation(models_.front(), measured, variance);
  std::array<double, kModels> likelihoods;
  for (std::size_t i = 0; i < kModels; ++i)
    likelihoods[i] = correct(models_[i], measured, variance, i == 0 ? kMinRestGain : 0.0);
  const double best = *std::max_element(likelihoods.begin(), likelihoods.end());
  double sum = 0.0;
  for (std::size_t i = 0; i < kModels; ++i)
    sum += models_[i].probability *= std::exp(likelihoods[i] - best);
  for (Model& model : models_)
    model.probability /= sum;
}

void CornerFilter::mix()
{
  const std::array<Model, kModels> before = models_;
  for (std::size_t to = 0; to < kModels; ++to)
  {
    Model& model = models_[to];
    std::array<double, kModels> shares;
    model.probability = 0.0;
    for (std::size_t from = 0; from < kModels; ++from)
    {
      shares[from] = before[from].probability * (from == to ? 1.0 - kModelChange : kModelChange / (kModels - 1));
      model.probability += shares[from];
    }
    model.position = model.velocity = State::all(0.0);
    model.covariance = cv::Matx22d::zeros();
    for (std::size_t from = 0; from < kModels; ++from)
    {
      shares[from] /= model.probability;
      model.position += shares[from] * before[from].position;
      model.velocity += shares[from] * before[from].velocity;
    }
    for (std::size_t from = 0; from < kModels; ++from)
    {
      const State p = before[from].position - model.position, v = before[from].velocity - model.velocity;
      const cv::Matx22d spread(p.dot(p), p.dot(v), p.dot(v), v.dot(v));
      model.covariance += shares[from] * (before[from].covariance + spread * (1.0 / kStateSize));
    }
  }
  models_[0].velocity = State::all(0.0);
  models_[0].covariance(0, 1) = models_[0].covariance(1, 0) = models_[0].covariance(1, 1) = 0.0;
}

void CornerFilter::predict(Model& model, double elapsed, double acceleration)
{
  const cv::Matx22d F(1.0, elapsed, 0.0, 1.0);
  const cv::Vec2d noise(acceleration * elapsed * elapsed / 2.0, acceleration * elapsed);
  model.position += elapsed * model.velocity;
  model.covariance = F * model.covariance * F.t() + noise * noise.t();
}

double CornerFilter::squaredInnovation(const Model& model, const State& seen, double variance)
{
  const State off = seen - model.position;
  return off.dot(off) / kStateSize / (model.covariance(0, 0) + variance);
}

double CornerFilter::correct(Model& model, const State& seen, double variance, double min_gain)
{
  const State off = seen - model.position;
  const double expected = model.covariance(0, 0) + variance;
  model.gain = std::max(model.covariance(0, 0) / expected, min_gain);
  const double velocity_gain = model.covariance(0, 1) / expected;
  model.position += model.gain * off;
  model.velocity += velocity_gain * off;
  // Joseph's form, which holds for any gain.
  const cv::Matx22d kept(1.0 - model.gain, 0.0, -velocity_gain, 1.0);
  const cv::Vec2d gains(model.gain, velocity_gain);
  model.covariance = kept * model.covariance * kept.t() + variance * (gains * gains.t());
  return -(off.dot(off) / expected + kStateSize * std::log(expected)) / 2.0;
}

CornerFilter::Corners CornerFilter::corners() const
{
  State mean = State::all(0.0);
  for (const Model& model : models_)
    mean += model.probability * model.position;
  return {cv::Point2d(mean[0], mean[1]), {mean[2], mean[3]}, {mean[4], mean[5]}, {mean[6], mean[7]}};
}

double CornerFilter::variance() const
{
  const State mean = coordinatesOf(corners());
  double sum = 0.0;
  for (const Model& model : models_)
  {
    const State off = model.position - mean;
    sum += model.probability * (model.covariance(0, 0) + off.dot(off) / kStateSize);
  }
  return sum;
}

double CornerFilter::gain() const
{
  double sum = 0.0;
  for (const Model& model : models_)
    sum += model.probability * model.gain;
  return sum;
}

}  // namespace robot_vision
