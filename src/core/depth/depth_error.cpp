#include "robot_vision/depth/depth_error.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{
namespace
{

constexpr double kNearest = 0.4;  // m, from where on the noise grows

}  // namespace

double stepDeviation(double depth, const DepthErrorParams& params)
{
  return params.depth_step * depth * depth / std::sqrt(12.0);  // of a uniform error
}

double depthDeviation(double depth, const DepthErrorParams& params)
{
  const double beyond = std::max(depth - kNearest, 0.0);
  return std::hypot(params.depth_noise + params.depth_noise_growth * beyond * beyond, stepDeviation(depth, params));
}

}  // namespace robot_vision
