#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>

namespace robot_vision::scene
{

/// Hashes a number to 64 well mixed bits, by the finaliser of SplitMix64.
inline std::uint64_t mix(std::uint64_t value)
{
  value += 0x9e3779b97f4a7c15;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9;
  value = (value ^ (value >> 27)) * 0x94d049bb133111eb;
  return value ^ (value >> 31);
}

/// The upper 53 bits of a hash as a double in [0, 1).
inline double unitInterval(std::uint64_t mixed)
{
  return static_cast<double>(mixed >> 11) * 0x1.0p-53;
}

/// Normally distributed numbers with a standard deviation of 1, one after the other. They are made by Box and Muller's
/// method, because std::normal_distribution differs between standard libraries.
class NormalNumbers
{
public:
  explicit NormalNumbers(std::uint64_t seed) : state_(seed) {}

  double next()
  {
    const double u = 1.0 - unitInterval(state_ = mix(state_)), v = unitInterval(state_ = mix(state_));
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * CV_PI * v);
  }

private:
  std::uint64_t state_;
};

}  // namespace robot_vision::scene
