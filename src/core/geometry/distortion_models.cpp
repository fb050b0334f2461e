#include "robot_vision/geometry/distortion_models.hpp"

#include <algorithm>

namespace robot_vision
{

bool isEquidistant(const std::string& distortion_model)
{
  return distortion_model == "equidistant" || distortion_model == "fisheye";
}

bool isPolynomial(const std::string& distortion_model)
{
  return distortion_model == "plumb_bob" || distortion_model == "rational_polynomial";
}

bool isDistorted(const CameraModel& camera)
{
  return isEquidistant(camera.distortion_model) ||
         std::any_of(camera.D.begin(), camera.D.end(), [](double coefficient) { return coefficient != 0.0; });
}

}  // namespace robot_vision
