#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/scene/texture_kernels.hpp"

/// What TextureKernels::draw() does, written plainly: one pixel and one channel after the other.
inline void drawPlainly(const robot_vision::scene::TexturePlane& texture, const float* xs, const float* ys, int count,
                        std::uint8_t* pixels)
{
  const auto between = [](int a, int b, int part) { return (256 * a + (b - a) * part + 128) / 256; };
  const float width = 256.0F * static_cast<float>(texture.width), height = 256.0F * static_cast<float>(texture.height);
  const float* const p = texture.plane;
  for (int i = 0; i < count; ++i)
  {
    const float depth = 1.0F / (p[6] * xs[i] + p[7] * ys[i] + p[8]);
    const float u = (p[0] * width * xs[i] + p[1] * width * ys[i] + p[2] * width) * depth;
    const float v = (p[3] * height * xs[i] + p[4] * height * ys[i] + p[5] * height) * depth;
    const int x = static_cast<int>(std::clamp(u + 128.5F, 0.0F, width + 255.0F));
    const int y = static_cast<int>(std::clamp(v + 128.5F, 0.0F, height + 255.0F));
    const std::uint32_t* const corner = texture.texels + y / 256 * (texture.width + 2) + x / 256;
    const std::uint32_t* const below = corner + texture.width + 2;
    int mixed[4];
    for (int k = 0; k < 4; ++k)
    {
      const auto channel = [k](std::uint32_t texel) { return static_cast<int>(texel >> (8 * k) & 255); };
      const int left = between(channel(corner[0]), channel(below[0]), y % 256);
      const int right = between(channel(corner[1]), channel(below[1]), y % 256);
      mixed[k] = between(left, right, x % 256);
    }
    for (int k = 0; k < 3; ++k)
    {
      std::uint8_t& to = pixels[3 * i + k];
      to = static_cast<std::uint8_t>((to * (255 - mixed[3]) + mixed[k] * mixed[3] + 127) / 255);
    }
  }
}
