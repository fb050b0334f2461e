#include "pose_ambiguity.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace robot_vision
{

namespace
{

const double kTurn = 1.0;         // rad/s, standard deviation about each axis
const double kMistaken = 0.0005;  // probability that the wrong one was followed to this frame

double rotationVariance(const PoseRefinement& fit)
{
  return fit.covariance(3, 3) + fit.covariance(4, 4) + fit.covariance(5, 5);
}

double angleBetween(const PoseRefinement& from, const PoseRefinement& to)
{
  return cv::norm(difference(from.pose, to.pose).get_minor<3, 1>(3, 0));
}

void normalise(std::vector<double>& weights)
{
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights)
    weight /= sum;
}

}  // namespace

std::vector<double> PoseAmbiguity::expected(double passed, const std::vector<PoseRefinement>& fits) const
{
  std::vector<double> probabilities(fits.size(), last_.empty() ? 1.0 : kMistaken);
  for (const WeighedPose& last : last_)
  {
    std::vector<double> ways(fits.size());
    for (std::size_t i = 0; i < fits.size(); ++i)
    {
      const double angle = angleBetween(last.fit, fits[i]);
      const double variance = kTurn * kTurn * passed * passed + rotationVariance(last.fit) + rotationVariance(fits[i]);
      ways[i] = -angle * angle / (2.0 * variance);
    }
    const double best = *std::max_element(ways.begin(), ways.end());
    for (double& way : ways)
      way = std::exp(way - best);
    normalise(ways);
    for (std::size_t i = 0; i < fits.size(); ++i)
      probabilities[i] += last.probability * ways[i];
  }
  normalise(probabilities);
  return probabilities;
}

std::vector<WeighedPose> PoseAmbiguity::update(double passed, const std::vector<PoseRefinement>& fits, double share)
{
  std::vector<double> probabilities = expected(passed, fits);
  const double least = fits[0].cost;
  for (std::size_t i = 0; i < fits.size(); ++i)
    probabilities[i] *= std::exp(share * (least - fits[i].cost) / 2.0);
  normalise(probabilities);

  std::vector<WeighedPose> weighed;
  for (std::size_t i = 0; i < fits.size(); ++i)
    weighed.push_back({fits[i], probabilities[i]});
  if (weighed.back().probability > weighed.front().probability) std::swap(weighed.front(), weighed.back());
  last_ = weighed;
  return weighed;
}

}  // namespace robot_vision
