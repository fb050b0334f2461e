#pragma once

#include <array>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// Filters the corners of a tag from frame to frame by interacting multiple models (Blom, Bar-Shalom: The Interacting
/// Multiple Model Algorithm for Systems with Markovian Switching Coefficients, 1988): one of a tag at rest and some of
/// tags that change their velocity more or less suddenly. All eight coordinates have the same noise, so one covariance
/// of position and velocity serves them all.
class CornerFilter
{
public:
  using Corners = std::array<cv::Point2d, 4>;

  /// Starts with the observed corners; `variance` (px^2) is that of each coordinate.
  CornerFilter(const Corners& seen, double variance);

  /// Adds the corners observed after `elapsed` s. The filter starts anew at corners that no motion explains.
  void update(double elapsed, const Corners& seen, double variance);

  Corners corners() const;
  double variance() const;  // px^2, of each coordinate

  double gain() const;                                    // weight of the newest frame in the corners, 0 to 1
  double rest() const { return models_[0].probability; }  // probability that the tag is at rest
  double change() const { return change_; }               // px^2, variance of the newest observation if it is at rest

private:
  using State = cv::Vec<double, 8>;
  struct Model
  {
    State position, velocity;  // px, px/s
    cv::Matx22d covariance;    // of position and velocity, for each coordinate
    double probability, gain;
  };
  static constexpr std::size_t kModels = 5;

  void mix();
  static void predict(Model& model, double elapsed, double acceleration);

  /// The mean square of the innovation divided by its variance: 1 on average.
  static double squaredInnovation(const Model& model, const State& seen, double variance);

  /// Corrects a model by the observed corners and returns their log likelihood.
  static double correct(Model& model, const State& seen, double variance, double min_gain);

  std::array<Model, kModels> models_;
  double change_ = 0.0;
};

}  // namespace robot_vision
