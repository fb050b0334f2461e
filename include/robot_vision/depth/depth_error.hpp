#pragma once

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

/// How wrong the distances of a depth camera are. The defaults are those of a Kinect: its noise along the line of sight
/// (Nguyen, Izadi, Lovell: Modeling Kinect Sensor Noise, 3DIMPVT 2012) and the steps of its disparity, an eighth of a
/// pixel.
struct DepthErrorParams
{
  double depth_noise = 0.0012;
  double depth_noise_growth = 0.0019;
  double depth_step = 0.0029;
  double depth_bias = 0.005;
  int depth_correlation = 4;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("depth_noise", &DepthErrorParams::depth_noise, Range{0.00001, 1}, "m",
          "standard deviation of a depth of at most 0.4 m");
    visit("depth_noise_growth", &DepthErrorParams::depth_noise_growth, Range{0, 1}, "1/m",
          "what it grows by with the square of the depth beyond 0.4 m");
    visit("depth_step", &DepthErrorParams::depth_step, Range{0, 1}, "1/m",
          "between the depths that the sensor can tell apart, divided by the square of the depth");
    visit("depth_bias", &DepthErrorParams::depth_bias, Range{0, 1}, "m",
          "standard deviation of what all depths of one thing have in common");
    visit("depth_correlation", &DepthErrorParams::depth_correlation, Range{1, 1000}, "px",
          "how many neighbouring pixels share their noise");
  }
};

/// The standard deviation (m) that the step of the sensor gives a depth (m).
double stepDeviation(double depth, const DepthErrorParams& params);

/// The standard deviation (m) of the depth (m) of one pixel: its noise and its step.
double depthDeviation(double depth, const DepthErrorParams& params);

}  // namespace robot_vision
