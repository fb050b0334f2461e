#include "scene_noise.hpp"

#include <algorithm>
#include <cmath>

#include "scene_random.hpp"

namespace robot_vision::scene
{

namespace
{

constexpr std::uint64_t kStartCount = 1 << 16;  // places in the tile where a row may start

}  // namespace

PixelNoise::PixelNoise(double sigma, std::uint64_t seed, int row_length) : seed_(mix(seed))
{
  if (sigma <= 0.0) return;
  tile_.resize(kStartCount + static_cast<std::size_t>(row_length));
  NormalNumbers normal(seed_);
  for (std::int8_t& value : tile_)
    value = static_cast<std::int8_t>(std::clamp(std::lround(sigma * normal.next()), -127L, 127L));
}

void PixelNoise::add(std::int64_t frame, cv::Mat& image) const
{
  if (tile_.empty()) return;
  const int length = image.cols * image.channels();
  const std::uint64_t frame_key = mix(seed_ ^ static_cast<std::uint64_t>(frame));
  for (int row = 0; row < image.rows; ++row)
  {
    const std::int8_t* noise = tile_.data() + mix(frame_key + static_cast<std::uint64_t>(row)) % kStartCount;
    std::uint8_t* pixels = image.ptr<std::uint8_t>(row);
    for (int i = 0; i < length; ++i)
    {
      // The compiler turns the 16-bit sum into saturating vector code.
      const auto sum = static_cast<std::int16_t>(pixels[i] + noise[i]);
      pixels[i] = static_cast<std::uint8_t>(std::clamp<std::int16_t>(sum, 0, 255));
    }
  }
}

}  // namespace robot_vision::scene
