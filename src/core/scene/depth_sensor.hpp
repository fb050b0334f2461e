#pragma once

#include "robot_vision/scene/depth_noise.hpp"

namespace robot_vision::scene
{

/// What distinguishes one kind of depth camera from another.
struct DepthSensorModel
{
  double baseline;              // m, to the other device at the right; 0: there is none
  double step;                  // px, of disparities; 0: it measures none
  double min_range, max_range;  // m
  int block;                    // px, side of the square whose pixels have errors that are alike; 1: they have not
  double flying;                // 0 to 1, of the pixels beside an edge that mix what is on its two sides

  /// The standard deviation (m) at a distance z (m). `disparity` is the baseline times the focal length, px m.
  double (*sigma)(double z, double disparity, double brightness);
};

/// Of any sensor but kExact.
const DepthSensorModel& sensorModel(DepthSensor sensor);

constexpr double kSteepCosine = 0.2588;  // of 75 degrees; nothing is lost where the cosine is larger

/// The share of pixels that are lost on a surface whose normal has an angle of this cosine to the ray.
double lostAtAngle(double cosine);

/// The share of pixels that are lost on a surface of this brightness, 0 to 255.
double lostAtBrightness(double brightness);

}  // namespace robot_vision::scene
