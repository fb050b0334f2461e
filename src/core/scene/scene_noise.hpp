#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision::scene
{

/// Gaussian pixel noise from a precomputed tile: each row of each frame starts at its own place in it.
class PixelNoise
{
public:
  /// `sigma`: standard deviation in gray levels; `row_length`: the longest row to come, in bytes.
  PixelNoise(double sigma, std::uint64_t seed, int row_length);

  /// Adds the noise of a frame to an 8-bit picture, clipping at 0 and 255.
  void add(std::int64_t frame, cv::Mat& picture) const;

private:
  std::uint64_t seed_;
  std::vector<std::int8_t> tile_;  // empty: no noise
};

}  // namespace robot_vision::scene
