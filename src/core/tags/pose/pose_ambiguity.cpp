#include "pose_ambiguity.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/geometry/rigid_motion.hpp"

namespace robot_vision
{

namespace
{

const double kAngularVelocity = 1.0;          // rad/s, standard deviation about each axis
const double kWrongPoseProbability = 0.0005;  // that the wrong pose was followed up to this frame

double rotationVariance(const PoseRefinement& fit)
{
  return fit.covariance(3, 3) + fit.covariance(4, 4) + fit.covariance(5, 5);
}

double angleBetween(const PoseRefinement& from, const PoseRefinement& to)
{
  return cv::norm(difference(from.pose, to.pose).get_minor<3, 1>(3, 0));
}

void normalize(std::vector<double>& weights)
{
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights)
    weight /= sum;
}

}  // namespace

std::vector<double> PoseAmbiguity::expected(double elapsed, const std::vector<PoseRefinement>& fits) const
{
  std::vector<double> probabilities(fits.size(), last_.empty() ? 1.0 : kWrongPoseProbability);
  for (const WeightedPose& last : last_)
  {
    std::vector<double> transitions(fits.size());
    for (std::size_t i = 0; i < fits.size(); ++i)
    {
      const double angle = angleBetween(last.fit, fits[i]);
      const double variance = kAngularVelocity * kAngularVelocity * elapsed * elapsed + rotationVariance(last.fit) +
                              rotationVariance(fits[i]);
      transitions[i] = -angle * angle / (2.0 * variance);
    }
    const double best = *std::max_element(transitions.begin(), transitions.end());
    for (double& transition : transitions)
      transition = std::exp(transition - best);
    normalize(transitions);
    for (std::size_t i = 0; i < fits.size(); ++i)
      probabilities[i] += last.probability * transitions[i];
  }
  normalize(probabilities);
  return probabilities;
}

std::vector<WeightedPose> PoseAmbiguity::update(double elapsed, const std::vector<PoseRefinement>& fits, double weight)
{
  std::vector<double> probabilities = expected(elapsed, fits);
  const double min_cost = fits[0].cost;
  for (std::size_t i = 0; i < fits.size(); ++i)
    probabilities[i] *= std::exp(weight * (min_cost - fits[i].cost) / 2.0);
  normalize(probabilities);

  std::vector<WeightedPose> weighted;
  for (std::size_t i = 0; i < fits.size(); ++i)
    weighted.push_back({fits[i], probabilities[i]});
  if (weighted.back().probability > weighted.front().probability) std::swap(weighted.front(), weighted.back());
  last_ = weighted;
  return weighted;
}

}  // namespace robot_vision
