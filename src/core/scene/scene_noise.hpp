#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision::scene
{

/// Gaussian pixel noise, read from a precomputed tile. Each row of each frame starts at its own place in the tile.
class PixelNoise
{
public:
  /// `sigma` is the standard deviation in gray levels, `row_length` the length in bytes of the longest row to come.
  PixelNoise(double sigma, std::uint64_t seed, int row_length);

  /// Adds the noise of a frame to an 8-bit image, clipping at 0 and 255.
  void add(std::int64_t frame, cv::Mat& image) const;

private:
  std::uint64_t seed_;
  std::vector<std::int8_t> tile_;  // empty when there is no noise
};

}  // namespace robot_vision::scene
