#include "yuv_kernels.hpp"

#include <cstdint>

#include "core/simd/pixel_vectors.hpp"

namespace robot_vision
{
namespace
{

void everySecond(const std::uint8_t* values, int count, std::uint8_t* __restrict results)
{
  for (int i = 0; i < count; ++i)
    results[i] = values[2 * i];
}

#ifdef ROBOT_VISION_PIXELS

// The factors of ITU-R BT.601, times 2^20 as in cv::cvtColor; all sums fit 32 bits.
constexpr int kShift = 20;
constexpr int kLuma = 1220542;
constexpr int kBlueOfU = 2116026;
constexpr int kGreenOfU = -409993;
constexpr int kGreenOfV = -852492;
constexpr int kRedOfV = 1673527;
constexpr int kRounding = 1 << (kShift - 1);
constexpr int kLumaOfBlack = 16;
constexpr int kNeutralChroma = 128;

/// Pairs of pixels, a pair in each integer. The luma is what exceeds kLumaOfBlack.
struct Pairs
{
  Simd::Vector first;
  Simd::Vector second;
  Simd::Vector u;
  Simd::Vector v;
};

/// Byte `i` of each integer, from the lowest.
inline Simd::Vector byteOf(Simd::Vector integers, int i)
{
  return Simd::And(PixelSimd::shiftIntegers(integers, 8 * i), Simd::integers(0xFF));
}

template <YuvLayout kLayout>
Pairs loadPairs(const YuvRow& row, int i)
{
  if constexpr (kLayout == YuvLayout::kYuyv || kLayout == YuvLayout::kUyvy)
  {
    constexpr int kOffset = kLayout == YuvLayout::kYuyv ? 0 : 1;
    const Simd::Vector chroma = Simd::load(row.luma + 4 * i);
    const Simd::Vector luma = PixelSimd::subtractSaturated(chroma, PixelSimd::bytes(kLumaOfBlack));
    return {byteOf(luma, kOffset), byteOf(luma, kOffset + 2), byteOf(chroma, 1 - kOffset), byteOf(chroma, 3 - kOffset)};
  }
  const Simd::Vector luma =
      PixelSimd::subtractSaturated(PixelSimd::integersOfWords(row.luma + 2 * i), PixelSimd::bytes(kLumaOfBlack));
  const Simd::Vector first = byteOf(luma, 0);
  const Simd::Vector second = byteOf(luma, 1);
  if constexpr (kLayout == YuvLayout::kPlanes)
    return {first, second, PixelSimd::integersOfBytes(row.u + i), PixelSimd::integersOfBytes(row.v + i)};
  const Simd::Vector chroma = PixelSimd::integersOfWords(row.u + 2 * i);
  constexpr int kOffset = kLayout == YuvLayout::kUv ? 0 : 1;
  return {first, second, byteOf(chroma, kOffset), byteOf(chroma, 1 - kOffset)};
}

inline Simd::Vector times(Simd::Vector a, int factor)
{
  return PixelSimd::multiplyIntegers(a, Simd::integers(factor));
}

inline Simd::Vector channel(Simd::Vector luma, Simd::Vector chroma)
{
  return PixelSimd::shiftSigned(Simd::addIntegers(luma, chroma), kShift);
}

template <YuvLayout kLayout, bool kRgb>
void convertPairs(const YuvRow& row, int i, std::uint8_t* pixels)
{
  const Pairs pairs = loadPairs<kLayout>(row, i);
  const Simd::Vector blue =
      Simd::addIntegers(times(pairs.u, kBlueOfU), Simd::integers(kRounding - kNeutralChroma * kBlueOfU));
  const Simd::Vector red =
      Simd::addIntegers(times(pairs.v, kRedOfV), Simd::integers(kRounding - kNeutralChroma * kRedOfV));
  const Simd::Vector green = Simd::addIntegers(Simd::addIntegers(times(pairs.u, kGreenOfU), times(pairs.v, kGreenOfV)),
                                               Simd::integers(kRounding - kNeutralChroma * (kGreenOfU + kGreenOfV)));
  const Simd::Vector one = kRgb ? red : blue;
  const Simd::Vector three = kRgb ? blue : red;
  const Simd::Vector first = times(pairs.first, kLuma);
  const Simd::Vector second = times(pairs.second, kLuma);
  const Simd::Vector a = PixelSimd::packIntegers(channel(first, one), channel(first, green));
  const Simd::Vector b = PixelSimd::packIntegers(channel(first, three), channel(second, one));
  const Simd::Vector c = PixelSimd::packIntegers(channel(second, green), channel(second, three));
  storePairs(pixels + 6 * i, PixelSimd::packWords(a, b), PixelSimd::packWords(c, c));
}

template <YuvLayout kLayout, bool kRgb>
void convertRow(const YuvRow& row, int pairs, std::uint8_t* pixels)
{
  constexpr int kPairs = static_cast<int>(sizeof(Simd::Vector)) / 4;
  for (int i = 0; i + kPairs <= pairs; i += kPairs)
    convertPairs<kLayout, kRgb>(row, i, pixels);
  if (pairs % kPairs != 0) convertPairs<kLayout, kRgb>(row, pairs - kPairs, pixels);
}

template <YuvLayout kLayout>
void convertRow(const YuvRow& row, int pairs, bool is_rgb, std::uint8_t* pixels)
{
  (is_rgb ? convertRow<kLayout, true> : convertRow<kLayout, false>)(row, pairs, pixels);
}

void convertYuv(const YuvRow& row, YuvLayout layout, int pairs, bool is_rgb, std::uint8_t* pixels)
{
  switch (layout)
  {
    case YuvLayout::kYuyv:
      return convertRow<YuvLayout::kYuyv>(row, pairs, is_rgb, pixels);
    case YuvLayout::kUyvy:
      return convertRow<YuvLayout::kUyvy>(row, pairs, is_rgb, pixels);
    case YuvLayout::kUv:
      return convertRow<YuvLayout::kUv>(row, pairs, is_rgb, pixels);
    case YuvLayout::kVu:
      return convertRow<YuvLayout::kVu>(row, pairs, is_rgb, pixels);
    case YuvLayout::kPlanes:
      return convertRow<YuvLayout::kPlanes>(row, pairs, is_rgb, pixels);
  }
}

#else

constexpr decltype(YuvKernels::yuv) convertYuv = nullptr;

#endif

}  // namespace

template <>
const YuvKernels KernelTable<YuvKernels, ROBOT_VISION_SET>::table = {
    everySecond,
    convertYuv,
};

}  // namespace robot_vision
