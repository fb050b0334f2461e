#include "texture_kernels.hpp"

#include <cstring>

#include "core/simd/kernel_numbers.hpp"
#include "core/simd/vectors.hpp"

namespace robot_vision
{
namespace scene
{
namespace
{

constexpr int kGroup = 4;         // pixels that are mixed at a time
constexpr int kFractionBits = 8;  // of texture coordinates
constexpr int kTexelUnit = 1 << kFractionBits;
#if defined(__SSSE3__)
constexpr int kPartBits = 15;  // of the parts that between() takes
#else
constexpr int kPartBits = kFractionBits;
#endif
constexpr std::uint32_t kTwoParts = 0x00010001U << (kPartBits - kFractionBits);

/// Eight words: two texels, or two pixels. Vectors of this size are made on all processors.
using Words = std::uint16_t __attribute__((vector_size(16)));
using Integers = std::uint32_t __attribute__((vector_size(16)));
using Halves = std::uint64_t __attribute__((vector_size(16)));
using Bytes = std::uint8_t __attribute__((vector_size(16)));

/// Where a run of pixels lies in a texture: the upper left of the four texels around each, and the fractions from there
/// on, as parts for between(), each twice.
struct Coordinates
{
  std::int32_t texel[TextureKernels::kMaxRun];
  std::uint32_t u[TextureKernels::kMaxRun], v[TextureKernels::kMaxRun];
};

void locate(const TexturePlane& texture, const float* xs, const float* ys, int count, Coordinates& at)
{
  const auto one = static_cast<float>(kTexelUnit);
  const float width = static_cast<float>(texture.width) * one, height = static_cast<float>(texture.height) * one;
  // The content starts half a texel after the middle of the border texel. The other 0.5 rounds to the nearest unit.
  const float shift = 0.5F * one + 0.5F, last_u = width + one - 1.0F, last_v = height + one - 1.0F;
  const float* const p = texture.plane;
  const float u_x = p[0] * width, u_y = p[1] * width, u_1 = p[2] * width;
  const float v_x = p[3] * height, v_y = p[4] * height, v_1 = p[5] * height;
  const float d_x = p[6], d_y = p[7], d_1 = p[8];
  const std::int32_t stride = texture.width + 2;
  for (int i = 0; i < count; ++i)
  {
    const float depth = 1.0F / (d_x * xs[i] + d_y * ys[i] + d_1);
    const float exact_u = (u_x * xs[i] + u_y * ys[i] + u_1) * depth + shift;
    const float exact_v = (v_x * xs[i] + v_y * ys[i] + v_1) * depth + shift;
    const auto u = static_cast<std::int32_t>(lesser(greater(exact_u, 0.0F), last_u));
    const auto v = static_cast<std::int32_t>(lesser(greater(exact_v, 0.0F), last_v));
    at.texel[i] = (v >> kFractionBits) * stride + (u >> kFractionBits);
    at.u[i] = static_cast<std::uint32_t>(u & (kTexelUnit - 1)) * kTwoParts;
    at.v[i] = static_cast<std::uint32_t>(v & (kTexelUnit - 1)) * kTwoParts;
  }
  for (int i = count; i % kGroup != 0; ++i)  // pixels that nobody sees
  {
    at.texel[i] = at.texel[count - 1];
    at.u[i] = at.v[i] = 0;
  }
}

/// Two neighbouring texels, or two pixels of four bytes, as words.
ROBOT_VISION_INLINE Words widened(const void* from)
{
#if defined(__SSE4_1__)
  return reinterpret_cast<Words>(_mm_cvtepu8_epi16(_mm_loadl_epi64(static_cast<const __m128i*>(from))));
#elif defined(__SSE2__)
  return reinterpret_cast<Words>(
      _mm_unpacklo_epi8(_mm_loadl_epi64(static_cast<const __m128i*>(from)), _mm_setzero_si128()));
#else
  using HalfBytes = std::uint8_t __attribute__((vector_size(8)));
  HalfBytes bytes;
  std::memcpy(&bytes, from, sizeof bytes);
  return __builtin_convertvector(bytes, Words);
#endif
}

/// a + (b - a) * part / 2^kPartBits, rounded to the nearest, halves up; a and b are from 0 to 255.
ROBOT_VISION_INLINE Words between(Words a, Words b, Integers parts)
{
  const auto part = reinterpret_cast<Words>(parts);
#if defined(__SSSE3__)
  return a +
         reinterpret_cast<Words>(_mm_mulhrs_epi16(reinterpret_cast<__m128i>(b - a), reinterpret_cast<__m128i>(part)));
#else
  // It fits 16 bits, and of (b - a) * part the lower 16 are enough.
  return ((a << kPartBits) + (b - a) * part + (1 << kPartBits) / 2) >> kPartBits;
#endif
}

ROBOT_VISION_INLINE Words lowerHalves(Words a, Words b)
{
#if defined(__SSE2__)
  return reinterpret_cast<Words>(_mm_unpacklo_epi64(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
  return reinterpret_cast<Words>(Halves{reinterpret_cast<Halves>(a)[0], reinterpret_cast<Halves>(b)[0]});
#endif
}

ROBOT_VISION_INLINE Words upperHalves(Words a, Words b)
{
#if defined(__SSE2__)
  return reinterpret_cast<Words>(_mm_unpackhi_epi64(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
  return reinterpret_cast<Words>(Halves{reinterpret_cast<Halves>(a)[1], reinterpret_cast<Halves>(b)[1]});
#endif
}

/// Two pixels between their texels, as words.
ROBOT_VISION_INLINE Words mixed(const TexturePlane& texture, const Coordinates& at, int i)
{
  const std::int32_t stride = texture.width + 2;
  const auto column = [&](int k)  // the texels on the left and on the right of a pixel, at its height
  {
    const std::uint32_t* const texel = texture.texels + at.texel[k];
    return between(widened(texel), widened(texel + stride), Integers{} + at.v[k]);
  };
  const Words first = column(i), second = column(i + 1);
  const Integers parts = {at.u[i], at.u[i], at.u[i + 1], at.u[i + 1]};
  return between(lowerHalves(first, second), upperHalves(first, second), parts);
}

/// The words of four pixels, from 0 to 255, as bytes.
ROBOT_VISION_INLINE Bytes narrowed(Words a, Words b)
{
#if defined(__SSE2__)
  return reinterpret_cast<Bytes>(_mm_packus_epi16(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
#else
  Bytes bytes;
  for (int i = 0; i < 8; ++i)
  {
    bytes[i] = static_cast<std::uint8_t>(a[i]);
    bytes[i + 8] = static_cast<std::uint8_t>(b[i]);
  }
  return bytes;
#endif
}

/// Stores the three colors of each of four pixels.
ROBOT_VISION_INLINE void storeColors(Bytes bgra, std::uint8_t* pixels)
{
#if defined(__SSSE3__)
  const __m128i order = _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1);
  const __m128i dense = _mm_shuffle_epi8(reinterpret_cast<__m128i>(bgra), order);
  std::memcpy(pixels, &dense, 3 * kGroup);
#else
  std::uint32_t each[kGroup];
  std::memcpy(each, &bgra, sizeof each);
  for (int i = 0; i < kGroup - 1; ++i)
    std::memcpy(pixels + 3 * i, each + i, 4);  // the next pixel overwrites the alpha
  std::memcpy(pixels + 9, each + kGroup - 1, 3);
#endif
}

/// Mixes four pixels into others.
ROBOT_VISION_INLINE void blend(Bytes bgra, std::uint8_t* pixels)
{
  for (int i = 0; i < kGroup; ++i)
  {
    const int alpha = bgra[4 * i + 3];
    for (int k = 0; k < 3; ++k)
    {
      std::uint8_t& to = pixels[3 * i + k];
      to = static_cast<std::uint8_t>((to * (255 - alpha) + bgra[4 * i + k] * alpha + 127) / 255);
    }
  }
}

/// Whether the alpha of all four pixels has this value, 0 or 255.
ROBOT_VISION_INLINE bool allHaveAlpha(Bytes bgra, std::uint8_t alpha)
{
#if defined(__SSE2__)
  const auto equal = reinterpret_cast<__m128i>(bgra == Bytes{} + alpha);
  return (_mm_movemask_epi8(equal) & 0x8888) == 0x8888;
#else
  return bgra[3] == alpha && bgra[7] == alpha && bgra[11] == alpha && bgra[15] == alpha;
#endif
}

ROBOT_VISION_INLINE void put(Bytes bgra, std::uint8_t* pixels)
{
  if (allHaveAlpha(bgra, 255))
    storeColors(bgra, pixels);
  else if (!allHaveAlpha(bgra, 0))
    blend(bgra, pixels);
}

void draw(const TexturePlane& texture, const float* xs, const float* ys, int count, std::uint8_t* pixels)
{
  Coordinates at;
  locate(texture, xs, ys, count, at);
  int i = 0;
  for (; i + kGroup <= count; i += kGroup)
    put(narrowed(mixed(texture, at, i), mixed(texture, at, i + 2)), pixels + 3 * i);
  if (i == count) return;
  std::uint8_t last[3 * kGroup] = {};
  const auto rest = 3 * static_cast<std::size_t>(count - i);
  std::memcpy(last, pixels + 3 * i, rest);
  put(narrowed(mixed(texture, at, i), mixed(texture, at, i + 2)), last);
  std::memcpy(pixels + 3 * i, last, rest);
}

}  // namespace
}  // namespace scene

template <>
const scene::TextureKernels KernelTable<scene::TextureKernels, ROBOT_VISION_SET>::table = {
    scene::draw,
};

}  // namespace robot_vision
