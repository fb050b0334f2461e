#pragma once

#include <array>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// Where the corners of a tag are, from where they were seen frame by frame: interacting multiple models (Blom,
/// Bar-Shalom: The Interacting Multiple Model Algorithm for Systems with Markovian Switching Coefficients, 1988) of a
/// tag at rest, and of some that change their velocity more or less suddenly. All eight coordinates have the same
/// noise, so one variance is enough for them.
class CornerFilter
{
public:
  using Corners = std::array<cv::Point2d, 4>;

  /// As seen, and the variance (px^2) of each coordinate.
  CornerFilter(const Corners& seen, double variance);

  /// As seen after `passed` s. Where no motion leads to is a beginning.
  void update(double passed, const Corners& seen, double variance);

  Corners corners() const;
  double variance() const;  // px^2, of each coordinate

  double gain() const;                                    // the share of the newest frame in the corners, 0 to 1
  double rest() const { return models_[0].probability; }  // probability that the tag does not move
  double change() const { return change_; }               // px^2, variance of what was seen, if it does not

private:
  using State = cv::Vec<double, 8>;
  struct Model
  {
    State position, velocity;  // px, px/s
    cv::Matx22d covariance;    // of the two, of each coordinate
    double probability, gain;
  };
  static constexpr std::size_t kModels = 5;

  void mix();
  static void predict(Model& model, double passed, double acceleration);

  /// The mean square of what is unexpected about what was seen, by its variance: 1 on average.
  static double surprise(const Model& model, const State& seen, double variance);

  /// The log likelihood of what was seen.
  static double correct(Model& model, const State& seen, double variance, double least_gain);

  std::array<Model, kModels> models_;
  double change_ = 0.0;
};

}  // namespace robot_vision
