#pragma once

#include <cstdint>

#include "vectors.hpp"

namespace robot_vision
{
namespace  // one for each instruction set
{

// What pixels of three bytes need: PixelSimd adds to Simd. With vectors of 16 bytes OpenCV is as fast.
#ifdef __AVX2__
#define ROBOT_VISION_PIXELS

/// For each byte of a vector, where in a plane the byte is that goes there when three planes become pixels. As 3 and
/// the vector's (or its parts') size have no common factor, one order serves all three vectors of pixels.
template <int kSize>
struct PlanePlaces
{
  constexpr PlanePlaces()
  {
    for (int channel = 0; channel < 3; ++channel)
      for (int i = 0; i < kSize; ++i)
        of[channel][i] = static_cast<std::uint8_t>((kSize * ((channel + 3 * kSize - i) % 3) + i) / 3);
  }

  std::uint8_t of[3][kSize] = {};
};

#if defined(__AVX512BW__)

struct PixelSimd : Simd
{
  static Vector bytes(int value) { return _mm512_set1_epi8(static_cast<char>(value)); }
  static Vector subtractBytes(Vector a, Vector b) { return _mm512_sub_epi8(a, b); }
  static Vector lowerBytes(Vector a, Vector b) { return _mm512_subs_epu8(a, b); }  // 0 at the least
  static Vector meanBytes(Vector a, Vector b) { return _mm512_avg_epu8(a, b); }
  static Vector differentBits(Vector a, Vector b) { return _mm512_xor_si512(a, b); }
  static Vector selectBits(Vector which, Vector a, Vector b) { return _mm512_ternarylogic_epi64(which, a, b, 0xCA); }
  static Vector multiplyIntegers(Vector a, Vector b) { return _mm512_mullo_epi32(a, b); }
  static Vector shiftIntegers(Vector a, int bits) { return _mm512_srl_epi32(a, _mm_cvtsi32_si128(bits)); }
  static Vector shiftSigned(Vector a, int bits) { return _mm512_sra_epi32(a, _mm_cvtsi32_si128(bits)); }
  static Vector packIntegers(Vector a, Vector b) { return _mm512_packs_epi32(a, b); }
  static Vector packWords(Vector a, Vector b) { return _mm512_packus_epi16(a, b); }
  static Vector shuffle(Vector a, const std::uint8_t* places) { return _mm512_shuffle_epi8(a, inAllParts(places)); }
  static Vector integersOfBytes(const void* from)
  {
    return _mm512_cvtepu8_epi32(_mm_loadu_si128(static_cast<const __m128i*>(from)));
  }
  static Vector integersOfWords(const void* from)
  {
    return _mm512_cvtepu16_epi32(_mm256_loadu_si256(static_cast<const __m256i*>(from)));
  }
  static Vector inAllParts(const void* sixteen)
  {
    return _mm512_broadcast_i32x4(_mm_loadu_si128(static_cast<const __m128i*>(sixteen)));
  }
  static __m128i part(Vector a, int i)
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
  static Vector bytes(int value) { return _mm256_set1_epi8(static_cast<char>(value)); }
  static Vector subtractBytes(Vector a, Vector b) { return _mm256_sub_epi8(a, b); }
  static Vector lowerBytes(Vector a, Vector b) { return _mm256_subs_epu8(a, b); }  // 0 at the least
  static Vector meanBytes(Vector a, Vector b) { return _mm256_avg_epu8(a, b); }
  static Vector differentBits(Vector a, Vector b) { return _mm256_xor_si256(a, b); }
  static Vector selectBits(Vector which, Vector a, Vector b)
  {
    return eitherBits(commonBits(which, a), _mm256_andnot_si256(which, b));
  }
  static Vector multiplyIntegers(Vector a, Vector b) { return _mm256_mullo_epi32(a, b); }
  static Vector shiftIntegers(Vector a, int bits) { return _mm256_srl_epi32(a, _mm_cvtsi32_si128(bits)); }
  static Vector shiftSigned(Vector a, int bits) { return _mm256_sra_epi32(a, _mm_cvtsi32_si128(bits)); }
  static Vector packIntegers(Vector a, Vector b) { return _mm256_packs_epi32(a, b); }
  static Vector packWords(Vector a, Vector b) { return _mm256_packus_epi16(a, b); }
  static Vector shuffle(Vector a, const std::uint8_t* places) { return _mm256_shuffle_epi8(a, inAllParts(places)); }
  static Vector integersOfBytes(const void* from)
  {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64(static_cast<const __m128i*>(from)));
  }
  static Vector integersOfWords(const void* from)
  {
    return _mm256_cvtepu16_epi32(_mm_loadu_si128(static_cast<const __m128i*>(from)));
  }
  static Vector inAllParts(const void* sixteen)
  {
    return _mm256_broadcastsi128_si256(_mm_loadu_si128(static_cast<const __m128i*>(sixteen)));
  }
  static __m128i part(Vector a, int i) { return i == 0 ? _mm256_castsi256_si128(a) : _mm256_extracti128_si256(a, 1); }
};

#endif

constexpr int kParts = static_cast<int>(sizeof(Simd::Vector)) / 16;

#ifdef __AVX512VBMI__

/// Of each byte of pixels, where in the two vectors of storePairs() it is.
struct PairPlaces
{
  constexpr PairPlaces()
  {
    for (int i = 0; i < 96; ++i)
    {
      const int part = i / 24;
      const int pair = i % 24 / 6;
      const int channel = i % 6;
      of[i] = static_cast<std::uint8_t>(channel < 4 ? 16 * part + 4 * channel + pair
                                                    : 64 + 16 * part + 4 * (channel - 4) + pair);
    }
  }

  std::uint8_t of[128] = {};
};

/// Pixels in pairs, of which each part of 16 bytes has four: of `a` the first pixels' three channels and the second
/// pixels' first one, four bytes of each, and of `b` the others.
inline void storePairs(std::uint8_t* to, Simd::Vector a, Simd::Vector b)
{
  static constexpr PairPlaces kPlaces;
  Simd::store(to, _mm512_permutex2var_epi8(a, Simd::load(kPlaces.of), b));
  const Simd::Vector rest = _mm512_permutex2var_epi8(a, Simd::load(kPlaces.of + 64), b);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + 64), _mm512_castsi512_si256(rest));
}

/// As many pixels as there are bytes in a vector.
inline void storePixels(std::uint8_t* to, Simd::Vector first, Simd::Vector second, Simd::Vector third)
{
  static constexpr PlanePlaces<64> kPlaces;
  constexpr __mmask64 kThirds = 0x9249249249249249;
  const auto mixed = [](Simd::Vector x, Simd::Vector y, Simd::Vector z)
  { return _mm512_mask_blend_epi8(kThirds << 2, _mm512_mask_blend_epi8(kThirds << 1, x, y), z); };
  const Simd::Vector a = _mm512_permutexvar_epi8(Simd::load(kPlaces.of[0]), first);
  const Simd::Vector b = _mm512_permutexvar_epi8(Simd::load(kPlaces.of[1]), second);
  const Simd::Vector c = _mm512_permutexvar_epi8(Simd::load(kPlaces.of[2]), third);
  Simd::store(to, mixed(a, b, c));
  Simd::store(to + 64, mixed(b, c, a));
  Simd::store(to + 128, mixed(c, a, b));
}

#else

inline void storePairs(std::uint8_t* to, Simd::Vector a, Simd::Vector b)
{
  constexpr std::uint8_t kNo = 0x80;
  static constexpr std::uint8_t kFirstOfA[] = {0, 4, 8, 12, kNo, kNo, 1, 5, 9, 13, kNo, kNo, 2, 6, 10, 14};
  static constexpr std::uint8_t kFirstOfB[] = {kNo, kNo, kNo, kNo, 0, 4, kNo, kNo, kNo, kNo, 1, 5, kNo, kNo, kNo, kNo};
  static constexpr std::uint8_t kRestOfA[16] = {kNo, kNo, 3, 7, 11, 15, kNo, kNo};
  static constexpr std::uint8_t kRestOfB[16] = {2, 6, kNo, kNo, kNo, kNo, 3, 7};
  const Simd::Vector first = Simd::eitherBits(PixelSimd::shuffle(a, kFirstOfA), PixelSimd::shuffle(b, kFirstOfB));
  const Simd::Vector rest = Simd::eitherBits(PixelSimd::shuffle(a, kRestOfA), PixelSimd::shuffle(b, kRestOfB));
  for (int i = 0; i < kParts; ++i)
  {
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + 24 * i), PixelSimd::part(first, i));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(to + 24 * i + 16), PixelSimd::part(rest, i));
  }
}

inline void storePixels(std::uint8_t* to, Simd::Vector first, Simd::Vector second, Simd::Vector third)
{
  static constexpr PlanePlaces<16> kPlaces;
  static constexpr std::uint8_t kSecond[] = {0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0};
  static constexpr std::uint8_t kThird[] = {0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0};
  const auto mixed = [](Simd::Vector x, Simd::Vector y, Simd::Vector z)
  {
    const Simd::Vector two = PixelSimd::selectBits(PixelSimd::inAllParts(kSecond), y, x);
    return PixelSimd::selectBits(PixelSimd::inAllParts(kThird), z, two);
  };
  const Simd::Vector a = PixelSimd::shuffle(first, kPlaces.of[0]);
  const Simd::Vector b = PixelSimd::shuffle(second, kPlaces.of[1]);
  const Simd::Vector c = PixelSimd::shuffle(third, kPlaces.of[2]);
  const Simd::Vector mixes[] = {mixed(a, b, c), mixed(b, c, a), mixed(c, a, b)};
  for (int i = 0; i < kParts; ++i)
    for (int j = 0; j < 3; ++j)
      _mm_storeu_si128(reinterpret_cast<__m128i*>(to + 48 * i + 16 * j), PixelSimd::part(mixes[j], i));
}

#endif

#endif

}  // namespace
}  // namespace robot_vision
