#pragma once

#include <cmath>

namespace robot_vision
{

/// The share, 0 to 1, by which a filtered value changes into one that was measured `elapsed` (s) after the last one.
/// `smoothing` is the filter's time constant (s), 0 for none.
inline double smoothingGain(double elapsed, double smoothing)
{
  return smoothing > 0.0 ? 1.0 - std::exp(-elapsed / smoothing) : 1.0;
}

}  // namespace robot_vision
