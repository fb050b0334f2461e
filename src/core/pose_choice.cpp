#include "pose_choice.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "body_pose.hpp"

namespace robot_vision
{

namespace
{

const double kTurn = 1.0;         // rad/s, standard deviation about each axis
const double kMistaken = 0.0005;  // probability that the wrong one was followed to this frame

double rotationVariance(const PoseFit& fit)
{
  const cv::Matx66d covariance = covarianceOf(fit);
  return covariance(3, 3) + covariance(4, 4) + covariance(5, 5);
}

void normalise(std::vector<double>& weights)
{
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights)
    weight /= sum;
}

}  // namespace

std::vector<double> PoseChoice::expected(double passed, const std::vector<PoseFit>& fits) const
{
  std::vector<double> probabilities(fits.size(), last_.empty() ? 1.0 : kMistaken);
  for (const Weighed& last : last_)
  {
    std::vector<double> ways(fits.size());
    for (std::size_t i = 0; i < fits.size(); ++i)
    {
      const cv::Vec6d way = difference(last.fit.pose, fits[i].pose);
      const double variance = kTurn * kTurn * passed * passed + rotationVariance(last.fit) + rotationVariance(fits[i]);
      ways[i] = -(way[3] * way[3] + way[4] * way[4] + way[5] * way[5]) / (2.0 * variance);
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

std::vector<double> PoseChoice::update(double passed, const std::vector<PoseFit>& fits, double share)
{
  std::vector<double> probabilities = expected(passed, fits);
  double least = fits[0].cost;
  for (const PoseFit& fit : fits)
    least = std::min(least, fit.cost);
  for (std::size_t i = 0; i < fits.size(); ++i)
    probabilities[i] *= std::exp(share * (least - fits[i].cost) / 2.0);
  normalise(probabilities);
  last_.clear();
  for (std::size_t i = 0; i < fits.size(); ++i)
    last_.push_back({fits[i], probabilities[i]});
  return probabilities;
}

}  // namespace robot_vision
