#pragma once

#include <cstdint>

#include "vectors.hpp"

namespace robot_vision
{
namespace  // unnamed, so that each instruction set has a copy of its own
{

// PixelSimd adds to Simd what kernels for pixels of three bytes need. It needs AVX2: with vectors of 16 bytes such
// kernels would be no faster than OpenCV. A lane is one of a vector's parts of 16 bytes.
#ifdef __AVX2__
#define ROBOT_VISION_PIXELS

/// The permutations that convert three planes (vectors of kSize bytes) to three vectors of interleaved pixels, and
/// back. As 3 and kSize have no common factor, a channel is at different positions in each of the three vectors of
/// pixels, so that one permutation for each channel serves all three of them.
template <int kSize>
struct InterleaveOrder
{
  constexpr InterleaveOrder()
  {
    for (int channel = 0; channel < 3; ++channel)
      for (int i = 0; i < kSize; ++i)
      {
        to_pixels[channel][i] = static_cast<std::uint8_t>((kSize * ((channel + 3 * kSize - i) % 3) + i) / 3);
        to_planes[channel][i] = static_cast<std::uint8_t>((3 * i + channel) % kSize);
      }
  }

  std::uint8_t to_pixels[3][kSize] = {};  // for each position among the pixels, the byte of the plane that goes there
  std::uint8_t to_planes[3][kSize] = {};  // for each position in the plane, the byte of the pixels that goes there
};

/// The channels of as many pixels as a vector has bytes.
struct Planes
{
  Simd::Vector first;
  Simd::Vector second;
  Simd::Vector third;
};

#if defined(__AVX512BW__)

struct PixelSimd : Simd
{
  using Mask = __mmask64;  // a flag for each byte

  static Mask greaterSigned(Vector a, Vector b) { return _mm512_cmpgt_epi8_mask(a, b); }
  static Mask lessEqualUnsigned(Vector a, Vector b) { return _mm512_cmple_epu8_mask(a, b); }
  static Mask both(Mask a, Mask b) { return a & b; }
  static bool any(Mask a) { return a != 0; }
  static Vector bytesWhere(Mask where, Vector a) { return _mm512_maskz_mov_epi8(where, a); }  // else 0
  static Vector maxBytes(Vector a, Vector b) { return _mm512_max_epu8(a, b); }
  static Vector minBytes(Vector a, Vector b) { return _mm512_min_epu8(a, b); }
  static Vector addSignedSaturated(Vector a, Vector b) { return _mm512_adds_epi8(a, b); }
  static Vector minWords(Vector a, Vector b) { return _mm512_min_epi16(a, b); }
  static Vector packSignedWords(Vector a, Vector b) { return _mm512_packs_epi16(a, b); }
  static Vector subtractBytes(Vector a, Vector b) { return _mm512_sub_epi8(a, b); }
  static Vector meanBytes(Vector a, Vector b) { return _mm512_avg_epu8(a, b); }  // halves are rounded up
  /// The bits of `a` where those of `which` are 1, else those of `b`.
  static Vector selectBits(Vector which, Vector a, Vector b) { return _mm512_ternarylogic_epi64(which, a, b, 0xCA); }
  static Vector multiplyIntegers(Vector a, Vector b) { return _mm512_mullo_epi32(a, b); }
  static Vector shiftIntegers(Vector a, int bits) { return _mm512_srl_epi32(a, _mm_cvtsi32_si128(bits)); }
  static Vector shiftSigned(Vector a, int bits) { return _mm512_sra_epi32(a, _mm_cvtsi32_si128(bits)); }
  static Vector packIntegers(Vector a, Vector b) { return _mm512_packs_epi32(a, b); }
  static Vector packWords(Vector a, Vector b) { return _mm512_packus_epi16(a, b); }
  /// Moves bytes within each lane: byte i of the result is byte `order`[i] of the lane, or 0 if `order`[i] is 0x80.
  static Vector shuffle(Vector a, const std::uint8_t* order) { return _mm512_shuffle_epi8(a, broadcastLane(order)); }
  static Vector upperBytes(Vector words) { return _mm512_srli_epi16(words, 8); }
  /// Stores integers from 0 to 255 as bytes, those of `a` first.
  static void storeIntegersAsBytes(std::uint8_t* to, Vector a, Vector b, Vector c, Vector d)
  {
    const Vector packed = packWords(packIntegers(a, b), packIntegers(c, d));
    const Vector order = _mm512_setr_epi32(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
    store(to, _mm512_permutexvar_epi32(order, packed));
  }
  static Vector integersOfBytes(const void* from)
  {
    return _mm512_cvtepu8_epi32(_mm_loadu_si128(static_cast<const __m128i*>(from)));
  }
  static Vector integersOfWords(const void* from)
  {
    return _mm512_cvtepu16_epi32(_mm256_loadu_si256(static_cast<const __m256i*>(from)));
  }
  static Vector broadcastLane(const void* lane)
  {
    return _mm512_broadcast_i32x4(_mm_loadu_si128(static_cast<const __m128i*>(lane)));
  }
  /// Loads each lane `step` bytes after the one before.
  static Vector loadLanes(const std::uint8_t* from, int step)
  {
    const auto at = [=](int i) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + i * step)); };
    const __m512i first = _mm512_inserti32x4(_mm512_castsi128_si512(at(0)), at(1), 1);
    return _mm512_inserti32x4(_mm512_inserti32x4(first, at(2), 2), at(3), 3);
  }
  static __m128i lane(Vector a, int i)
  {
    return i == 0   ? _mm512_castsi512_si128(a)
           : i == 1 ? _mm512_extracti32x4_epi32(a, 1)
           : i == 2 ? _mm512_extracti32x4_epi32(a, 2)
                    : _mm512_extracti32x4_epi32(a, 3);
  }
};

#else

struct PixelSimd : Simd
{
  using Mask = Vector;

  static Mask greaterSigned(Vector a, Vector b) { return _mm256_cmpgt_epi8(a, b); }
  static Mask lessEqualUnsigned(Vector a, Vector b) { return _mm256_cmpeq_epi8(minBytes(a, b), a); }
  static Mask both(Mask a, Mask b) { return And(a, b); }
  static bool any(Mask a) { return _mm256_testz_si256(a, a) == 0; }
  static Vector bytesWhere(Mask where, Vector a) { return And(where, a); }
  static Vector maxBytes(Vector a, Vector b) { return _mm256_max_epu8(a, b); }
  static Vector minBytes(Vector a, Vector b) { return _mm256_min_epu8(a, b); }
  static Vector addSignedSaturated(Vector a, Vector b) { return _mm256_adds_epi8(a, b); }
  static Vector minWords(Vector a, Vector b) { return _mm256_min_epi16(a, b); }
  static Vector packSignedWords(Vector a, Vector b) { return _mm256_packs_epi16(a, b); }
  static Vector subtractBytes(Vector a, Vector b) { return _mm256_sub_epi8(a, b); }
  static Vector meanBytes(Vector a, Vector b) { return _mm256_avg_epu8(a, b); }
  static Vector selectBits(Vector which, Vector a, Vector b)
  {
    return Or(And(which, a), _mm256_andnot_si256(which, b));
  }
  static Vector multiplyIntegers(Vector a, Vector b) { return _mm256_mullo_epi32(a, b); }
  static Vector shiftIntegers(Vector a, int bits) { return _mm256_srl_epi32(a, _mm_cvtsi32_si128(bits)); }
  static Vector shiftSigned(Vector a, int bits) { return _mm256_sra_epi32(a, _mm_cvtsi32_si128(bits)); }
  static Vector packIntegers(Vector a, Vector b) { return _mm256_packs_epi32(a, b); }
  static Vector packWords(Vector a, Vector b) { return _mm256_packus_epi16(a, b); }
  static Vector shuffle(Vector a, const std::uint8_t* order) { return _mm256_shuffle_epi8(a, broadcastLane(order)); }
  static Vector upperBytes(Vector words) { return _mm256_srli_epi16(words, 8); }
  static void storeIntegersAsBytes(std::uint8_t* to, Vector a, Vector b, Vector c, Vector d)
  {
    const Vector packed = packWords(packIntegers(a, b), packIntegers(c, d));
    store(to, _mm256_permutevar8x32_epi32(packed, _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7)));
  }
  static Vector integersOfBytes(const void* from)
  {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64(static_cast<const __m128i*>(from)));
  }
  static Vector integersOfWords(const void* from)
  {
    return _mm256_cvtepu16_epi32(_mm_loadu_si128(static_cast<const __m128i*>(from)));
  }
  static Vector broadcastLane(const void* lane)
  {
    return _mm256_broadcastsi128_si256(_mm_loadu_si128(static_cast<const __m128i*>(lane)));
  }
  static Vector loadLanes(const std::uint8_t* from, int step)
  {
    const auto at = [=](int i) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + i * step)); };
    return _mm256_inserti128_si256(_mm256_castsi128_si256(at(0)), at(1), 1);
  }
  static __m128i lane(Vector a, int i) { return i == 0 ? _mm256_castsi256_si128(a) : _mm256_extracti128_si256(a, 1); }
};

#endif

constexpr int kLanes = static_cast<int>(sizeof(Simd::Vector)) / 16;

/// Loads one pixel into each integer of a vector. Pixels of three channels leave the fourth byte undefined.
template <int kChannels>
Simd::Vector loadPixels(const std::uint8_t* from)
{
  if constexpr (kChannels == 4) return Simd::load(from);
  static constexpr std::uint8_t kFours[16] = {0, 1, 2, 0, 3, 4, 5, 0, 6, 7, 8, 0, 9, 10, 11, 0};
#ifdef __AVX512BW__
  const Simd::Vector dense = _mm512_maskz_loadu_epi32(0x0FFF, from);
  const Simd::Vector lanes = _mm512_setr_epi32(0, 1, 2, 0, 3, 4, 5, 0, 6, 7, 8, 0, 9, 10, 11, 0);
  return PixelSimd::shuffle(_mm512_maskz_permutexvar_epi32(0x7777, lanes, dense), kFours);
#else
  const auto lane = [](const std::uint8_t* at) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(at)); };
  const __m128i last = _mm_srli_si128(lane(from + 8), 4);  // does not read beyond the pixels
  return PixelSimd::shuffle(_mm256_inserti128_si256(_mm256_castsi128_si256(lane(from)), last, 1), kFours);
#endif
}

#ifdef __AVX512VBMI__

/// For each byte of the pixels that storePairs() writes, its index in the two vectors.
struct PairOrder
{
  constexpr PairOrder()
  {
    for (int i = 0; i < 96; ++i)
    {
      const int lane = i / 24;
      const int pair = i % 24 / 6;
      const int channel = i % 6;
      index[i] = static_cast<std::uint8_t>(channel < 4 ? 16 * lane + 4 * channel + pair
                                                       : 64 + 16 * lane + 4 * (channel - 4) + pair);
    }
  }

  std::uint8_t index[128] = {};
};

/// Stores pairs of pixels of three channels, four pairs from each lane. A lane of `a` has four bytes for each of the
/// first pixels' three channels, then four for the second pixels' first channel; `b` begins with the second pixels'
/// other two channels.
inline void storePairs(std::uint8_t* to, Simd::Vector a, Simd::Vector b)
{
  static constexpr PairOrder kOrder;
  Simd::store(to, _mm512_permutex2var_epi8(a, Simd::load(kOrder.index), b));
  const Simd::Vector rest = _mm512_permutex2var_epi8(a, Simd::load(kOrder.index + 64), b);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + 64), _mm512_castsi512_si256(rest));
}

/// Takes of every three bytes the first from `x`, the second from `y` and the third from `z`.
inline Simd::Vector blendThirds(Simd::Vector x, Simd::Vector y, Simd::Vector z)
{
  constexpr __mmask64 kThirds = 0x9249249249249249;
  return _mm512_mask_blend_epi8(kThirds << 2, _mm512_mask_blend_epi8(kThirds << 1, x, y), z);
}

inline void StoreInterleaved3(std::uint8_t* to, const Planes& planes)
{
  static constexpr InterleaveOrder<64> kOrder;
  const Simd::Vector a = _mm512_permutexvar_epi8(Simd::load(kOrder.to_pixels[0]), planes.first);
  const Simd::Vector b = _mm512_permutexvar_epi8(Simd::load(kOrder.to_pixels[1]), planes.second);
  const Simd::Vector c = _mm512_permutexvar_epi8(Simd::load(kOrder.to_pixels[2]), planes.third);
  Simd::store(to, blendThirds(a, b, c));
  Simd::store(to + 64, blendThirds(b, c, a));
  Simd::store(to + 128, blendThirds(c, a, b));
}

inline Planes loadPlanes(const std::uint8_t* from)
{
  static constexpr InterleaveOrder<64> kOrder;
  const Simd::Vector a = Simd::load(from);
  const Simd::Vector b = Simd::load(from + 64);
  const Simd::Vector c = Simd::load(from + 128);
  return {_mm512_permutexvar_epi8(Simd::load(kOrder.to_planes[0]), blendThirds(a, c, b)),
          _mm512_permutexvar_epi8(Simd::load(kOrder.to_planes[1]), blendThirds(b, a, c)),
          _mm512_permutexvar_epi8(Simd::load(kOrder.to_planes[2]), blendThirds(c, b, a))};
}

#else

inline void storePairs(std::uint8_t* to, Simd::Vector a, Simd::Vector b)
{
  constexpr std::uint8_t kNo = 0x80;  // makes shuffle() write 0
  static constexpr std::uint8_t kFirstOfA[] = {0, 4, 8, 12, kNo, kNo, 1, 5, 9, 13, kNo, kNo, 2, 6, 10, 14};
  static constexpr std::uint8_t kFirstOfB[] = {kNo, kNo, kNo, kNo, 0, 4, kNo, kNo, kNo, kNo, 1, 5, kNo, kNo, kNo, kNo};
  static constexpr std::uint8_t kRestOfA[16] = {kNo, kNo, 3, 7, 11, 15, kNo, kNo};
  static constexpr std::uint8_t kRestOfB[16] = {2, 6, kNo, kNo, kNo, kNo, 3, 7};
  const Simd::Vector first = Simd::Or(PixelSimd::shuffle(a, kFirstOfA), PixelSimd::shuffle(b, kFirstOfB));
  const Simd::Vector rest = Simd::Or(PixelSimd::shuffle(a, kRestOfA), PixelSimd::shuffle(b, kRestOfB));
  for (int i = 0; i < kLanes; ++i)
  {
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + 24 * i), PixelSimd::lane(first, i));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(to + 24 * i + 16), PixelSimd::lane(rest, i));
  }
}

inline Simd::Vector blendThirds(Simd::Vector x, Simd::Vector y, Simd::Vector z)
{
  static constexpr std::uint8_t kSecond[] = {0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0};
  static constexpr std::uint8_t kThird[] = {0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0};
  const Simd::Vector two = PixelSimd::selectBits(PixelSimd::broadcastLane(kSecond), y, x);
  return PixelSimd::selectBits(PixelSimd::broadcastLane(kThird), z, two);
}

inline void StoreInterleaved3(std::uint8_t* to, const Planes& planes)
{
  static constexpr InterleaveOrder<16> kOrder;
  const Simd::Vector a = PixelSimd::shuffle(planes.first, kOrder.to_pixels[0]);
  const Simd::Vector b = PixelSimd::shuffle(planes.second, kOrder.to_pixels[1]);
  const Simd::Vector c = PixelSimd::shuffle(planes.third, kOrder.to_pixels[2]);
  const Simd::Vector blends[] = {blendThirds(a, b, c), blendThirds(b, c, a), blendThirds(c, a, b)};
  for (int i = 0; i < kLanes; ++i)
    for (int j = 0; j < 3; ++j)
      _mm_storeu_si128(reinterpret_cast<__m128i*>(to + 48 * i + 16 * j), PixelSimd::lane(blends[j], i));
}

inline Planes loadPlanes(const std::uint8_t* from)
{
  static constexpr InterleaveOrder<16> kOrder;
  const Simd::Vector a = PixelSimd::loadLanes(from, 48);
  const Simd::Vector b = PixelSimd::loadLanes(from + 16, 48);
  const Simd::Vector c = PixelSimd::loadLanes(from + 32, 48);
  return {PixelSimd::shuffle(blendThirds(a, c, b), kOrder.to_planes[0]),
          PixelSimd::shuffle(blendThirds(b, a, c), kOrder.to_planes[1]),
          PixelSimd::shuffle(blendThirds(c, b, a), kOrder.to_planes[2])};
}

#endif

#endif

}  // namespace
}  // namespace robot_vision
