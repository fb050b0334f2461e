#pragma once

#include <cmath>

namespace robot_vision
{

constexpr double kMinInterval = 1e-3;  // s, the shortest time in which a velocity can be measured

/// The share, 0 to 1, by which a filtered velocity changes into one that was measured over `elapsed` (s). `smoothing`
/// is the filter's time constant (s), 0 for none.
inline double velocityGain(double elapsed, double smoothing)
{
  return smoothing > 0.0 ? 1.0 - std::exp(-elapsed / smoothing) : 1.0;
}

}  // namespace robot_vision
