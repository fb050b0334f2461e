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

/// Of vectors with as many bytes, of three planes or of pixels of three channels that follow each other: as 3 and the
/// size have no common factor, a channel has its bytes at other places in each of the pixels' three vectors, so that
/// one order serves all of them.
template <int kSize>
struct PlanePlaces
{
  constexpr PlanePlaces()
  {
    for (int channel = 0; channel < 3; ++channel)
      for (int i = 0; i < kSize; ++i)
      {
        of_pixels[channel][i] = static_cast<std::uint8_t>((kSize * ((channel + 3 * kSize - i) % 3) + i) / 3);
        of_planes[channel][i] = static_cast<std::uint8_t>((3 * i + channel) % kSize);
      }
  }

  std::uint8_t of_pixels[3][kSize] = {};  // where in its plane the byte is that goes to a place among pixels
  std::uint8_t of_planes[3][kSize] = {};  // where among pixels the byte is that goes to a place in its plane
};

/// As many pixels as there are bytes in a vector.
struct Planes
{
  Simd::Vector first;
  Simd::Vector second;
  Simd::Vector third;
};

#if defined(__AVX512BW__)

struct PixelSimd : Simd
{
  using Flags = __mmask64;  // one for each byte

  static Flags aboveSigned(Vector a, Vector b) { return _mm512_cmpgt_epi8_mask(a, b); }
  static Flags notAboveUnsigned(Vector a, Vector b) { return _mm512_cmple_epu8_mask(a, b); }
  static Flags both(Flags a, Flags b) { return a & b; }
  static bool any(Flags a) { return a != 0; }
  static Vector bytesWhere(Flags where, Vector a) { return _mm512_maskz_mov_epi8(where, a); }
  static Vector largerBytes(Vector a, Vector b) { return _mm512_max_epu8(a, b); }
  static Vector smallerBytes(Vector a, Vector b) { return _mm512_min_epu8(a, b); }
  static Vector addSignedBytes(Vector a, Vector b) { return _mm512_adds_epi8(a, b); }  // limited
  static Vector smallerWords(Vector a, Vector b) { return _mm512_min_epi16(a, b); }
  static Vector packSignedWords(Vector a, Vector b) { return _mm512_packs_epi16(a, b); }
  static Vector subtractBytes(Vector a, Vector b) { return _mm512_sub_epi8(a, b); }
  static Vector meanBytes(Vector a, Vector b) { return _mm512_avg_epu8(a, b); }
  static Vector selectBits(Vector which, Vector a, Vector b) { return _mm512_ternarylogic_epi64(which, a, b, 0xCA); }
  static Vector multiplyIntegers(Vector a, Vector b) { return _mm512_mullo_epi32(a, b); }
  static Vector shiftIntegers(Vector a, int bits) { return _mm512_srl_epi32(a, _mm_cvtsi32_si128(bits)); }
  static Vector shiftSigned(Vector a, int bits) { return _mm512_sra_epi32(a, _mm_cvtsi32_si128(bits)); }
  static Vector packIntegers(Vector a, Vector b) { return _mm512_packs_epi32(a, b); }
  static Vector packWords(Vector a, Vector b) { return _mm512_packus_epi16(a, b); }
  static Vector shuffle(Vector a, const std::uint8_t* places) { return _mm512_shuffle_epi8(a, inAllParts(places)); }
  static Vector upperBytes(Vector words) { return _mm512_srli_epi16(words, 8); }
  /// Integers of 0 to 255, those of `a` first.
  static void storeIntegersAsBytes(std::uint8_t* to, Vector a, Vector b, Vector c, Vector d)
  {
    const Vector packed = packWords(packIntegers(a, b), packIntegers(c, d));
    const Vector places = _mm512_setr_epi32(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
    store(to, _mm512_permutexvar_epi32(places, packed));
  }
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
  static Vector loadParts(const std::uint8_t* from, int step)
  {
    const auto part = [=](int i) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + i * step)); };
    const __m512i first = _mm512_inserti32x4(_mm512_castsi128_si512(part(0)), part(1), 1);
    return _mm512_inserti32x4(_mm512_inserti32x4(first, part(2), 2), part(3), 3);
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
  using Flags = Vector;

  static Flags aboveSigned(Vector a, Vector b) { return _mm256_cmpgt_epi8(a, b); }
  static Flags notAboveUnsigned(Vector a, Vector b) { return _mm256_cmpeq_epi8(smallerBytes(a, b), a); }
  static Flags both(Flags a, Flags b) { return And(a, b); }
  static bool any(Flags a) { return _mm256_testz_si256(a, a) == 0; }
  static Vector bytesWhere(Flags where, Vector a) { return And(where, a); }
  static Vector largerBytes(Vector a, Vector b) { return _mm256_max_epu8(a, b); }
  static Vector smallerBytes(Vector a, Vector b) { return _mm256_min_epu8(a, b); }
  static Vector addSignedBytes(Vector a, Vector b) { return _mm256_adds_epi8(a, b); }
  static Vector smallerWords(Vector a, Vector b) { return _mm256_min_epi16(a, b); }
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
  static Vector shuffle(Vector a, const std::uint8_t* places) { return _mm256_shuffle_epi8(a, inAllParts(places)); }
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
  static Vector inAllParts(const void* sixteen)
  {
    return _mm256_broadcastsi128_si256(_mm_loadu_si128(static_cast<const __m128i*>(sixteen)));
  }
  static Vector loadParts(const std::uint8_t* from, int step)
  {
    const auto part = [=](int i) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + i * step)); };
    return _mm256_inserti128_si256(_mm256_castsi128_si256(part(0)), part(1), 1);
  }
  static __m128i part(Vector a, int i) { return i == 0 ? _mm256_castsi256_si128(a) : _mm256_extracti128_si256(a, 1); }
};

#endif

constexpr int kParts = static_cast<int>(sizeof(Simd::Vector)) / 16;

/// As many pixels as a vector has integers, one in each; of three channels, with any fourth byte.
template <int kChannels>
Simd::Vector loadPixels(const std::uint8_t* from)
{
  if constexpr (kChannels == 4) return Simd::load(from);
  static constexpr std::uint8_t kFours[16] = {0, 1, 2, 0, 3, 4, 5, 0, 6, 7, 8, 0, 9, 10, 11, 0};
#ifdef __AVX512BW__
  const Simd::Vector dense = _mm512_maskz_loadu_epi32(0x0FFF, from);
  const Simd::Vector parts = _mm512_setr_epi32(0, 1, 2, 0, 3, 4, 5, 0, 6, 7, 8, 0, 9, 10, 11, 0);
  return PixelSimd::shuffle(_mm512_maskz_permutexvar_epi32(0x7777, parts, dense), kFours);
#else
  const auto part = [](const std::uint8_t* at) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(at)); };
  const __m128i last = _mm_srli_si128(part(from + 8), 4);  // not to read beyond the pixels
  return PixelSimd::shuffle(_mm256_inserti128_si256(_mm256_castsi128_si256(part(from)), last, 1), kFours);
#endif
}

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

/// Of every three bytes one of each.
inline Simd::Vector mixThirds(Simd::Vector x, Simd::Vector y, Simd::Vector z)
{
  constexpr __mmask64 kThirds = 0x9249249249249249;
  return _mm512_mask_blend_epi8(kThirds << 2, _mm512_mask_blend_epi8(kThirds << 1, x, y), z);
}

inline void StoreInterleaved3(std::uint8_t* to, const Planes& planes)
{
  static constexpr PlanePlaces<64> kPlaces;
  const Simd::Vector a = _mm512_permutexvar_epi8(Simd::load(kPlaces.of_pixels[0]), planes.first);
  const Simd::Vector b = _mm512_permutexvar_epi8(Simd::load(kPlaces.of_pixels[1]), planes.second);
  const Simd::Vector c = _mm512_permutexvar_epi8(Simd::load(kPlaces.of_pixels[2]), planes.third);
  Simd::store(to, mixThirds(a, b, c));
  Simd::store(to + 64, mixThirds(b, c, a));
  Simd::store(to + 128, mixThirds(c, a, b));
}

inline Planes loadPlanes(const std::uint8_t* from)
{
  static constexpr PlanePlaces<64> kPlaces;
  const Simd::Vector a = Simd::load(from);
  const Simd::Vector b = Simd::load(from + 64);
  const Simd::Vector c = Simd::load(from + 128);
  return {_mm512_permutexvar_epi8(Simd::load(kPlaces.of_planes[0]), mixThirds(a, c, b)),
          _mm512_permutexvar_epi8(Simd::load(kPlaces.of_planes[1]), mixThirds(b, a, c)),
          _mm512_permutexvar_epi8(Simd::load(kPlaces.of_planes[2]), mixThirds(c, b, a))};
}

#else

inline void storePairs(std::uint8_t* to, Simd::Vector a, Simd::Vector b)
{
  constexpr std::uint8_t kNo = 0x80;
  static constexpr std::uint8_t kFirstOfA[] = {0, 4, 8, 12, kNo, kNo, 1, 5, 9, 13, kNo, kNo, 2, 6, 10, 14};
  static constexpr std::uint8_t kFirstOfB[] = {kNo, kNo, kNo, kNo, 0, 4, kNo, kNo, kNo, kNo, 1, 5, kNo, kNo, kNo, kNo};
  static constexpr std::uint8_t kRestOfA[16] = {kNo, kNo, 3, 7, 11, 15, kNo, kNo};
  static constexpr std::uint8_t kRestOfB[16] = {2, 6, kNo, kNo, kNo, kNo, 3, 7};
  const Simd::Vector first = Simd::Or(PixelSimd::shuffle(a, kFirstOfA), PixelSimd::shuffle(b, kFirstOfB));
  const Simd::Vector rest = Simd::Or(PixelSimd::shuffle(a, kRestOfA), PixelSimd::shuffle(b, kRestOfB));
  for (int i = 0; i < kParts; ++i)
  {
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + 24 * i), PixelSimd::part(first, i));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(to + 24 * i + 16), PixelSimd::part(rest, i));
  }
}

inline Simd::Vector mixThirds(Simd::Vector x, Simd::Vector y, Simd::Vector z)
{
  static constexpr std::uint8_t kSecond[] = {0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0};
  static constexpr std::uint8_t kThird[] = {0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0};
  const Simd::Vector two = PixelSimd::selectBits(PixelSimd::inAllParts(kSecond), y, x);
  return PixelSimd::selectBits(PixelSimd::inAllParts(kThird), z, two);
}

inline void StoreInterleaved3(std::uint8_t* to, const Planes& planes)
{
  static constexpr PlanePlaces<16> kPlaces;
  const Simd::Vector a = PixelSimd::shuffle(planes.first, kPlaces.of_pixels[0]);
  const Simd::Vector b = PixelSimd::shuffle(planes.second, kPlaces.of_pixels[1]);
  const Simd::Vector c = PixelSimd::shuffle(planes.third, kPlaces.of_pixels[2]);
  const Simd::Vector mixes[] = {mixThirds(a, b, c), mixThirds(b, c, a), mixThirds(c, a, b)};
  for (int i = 0; i < kParts; ++i)
    for (int j = 0; j < 3; ++j)
      _mm_storeu_si128(reinterpret_cast<__m128i*>(to + 48 * i + 16 * j), PixelSimd::part(mixes[j], i));
}

inline Planes loadPlanes(const std::uint8_t* from)
{
  static constexpr PlanePlaces<16> kPlaces;
  const Simd::Vector a = PixelSimd::loadParts(from, 48);
  const Simd::Vector b = PixelSimd::loadParts(from + 16, 48);
  const Simd::Vector c = PixelSimd::loadParts(from + 32, 48);
  return {PixelSimd::shuffle(mixThirds(a, c, b), kPlaces.of_planes[0]),
          PixelSimd::shuffle(mixThirds(b, a, c), kPlaces.of_planes[1]),
          PixelSimd::shuffle(mixThirds(c, b, a), kPlaces.of_planes[2])};
}

#endif

#endif

}  // namespace
}  // namespace robot_vision
