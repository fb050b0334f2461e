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

// ITU-R BT.601 in 2^-20ths, as cv::cvtColor has it, in 32 bits.
constexpr int kShift = 20;
constexpr int kLuma = 1220542;
constexpr int kBlueOfU = 2116026;
constexpr int kGreenOfU = -409993;
constexpr int kGreenOfV = -852492;
constexpr int kRedOfV = 1673527;
constexpr int kHalf = 1 << (kShift - 1);
constexpr int kBlack = 16;  // of luma
constexpr int kNone = 128;  // of chroma

/// Pairs of pixels, each in an integer; of luma what is above black.
struct Pairs
{
  Simd::Vector first;
  Simd::Vector second;
  Simd::Vector u;
  Simd::Vector v;
};

inline Simd::Vector byteOf(Simd::Vector integers, int i)
{
  return Simd::And(PixelSimd::shiftIntegers(integers, 8 * i), Simd::integers(0xFF));
}

template <YuvLayout kLayout>
Pairs loadPairs(const YuvRow& row, int i)
{
  if constexpr (kLayout == YuvLayout::kYuyv || kLayout == YuvLayout::kUyvy)
  {
    constexpr int kAt = kLayout == YuvLayout::kYuyv ? 0 : 1;
    const Simd::Vector chroma = Simd::load(row.luma + 4 * i);
    const Simd::Vector luma = PixelSimd::subtractSaturated(chroma, PixelSimd::bytes(kBlack));
    return {byteOf(luma, kAt), byteOf(luma, kAt + 2), byteOf(chroma, 1 - kAt), byteOf(chroma, 3 - kAt)};
  }
  const Simd::Vector luma =
      PixelSimd::subtractSaturated(PixelSimd::integersOfWords(row.luma + 2 * i), PixelSimd::bytes(kBlack));
  const Simd::Vector first = byteOf(luma, 0);
  const Simd::Vector second = byteOf(luma, 1);
  if constexpr (kLayout == YuvLayout::kPlanes)
    return {first, second, PixelSimd::integersOfBytes(row.u + i), PixelSimd::integersOfBytes(row.v + i)};
  const Simd::Vector chroma = PixelSimd::integersOfWords(row.u + 2 * i);
  constexpr int kAt = kLayout == YuvLayout::kUv ? 0 : 1;
  return {first, second, byteOf(chroma, kAt), byteOf(chroma, 1 - kAt)};
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
void colourPairs(const YuvRow& row, int i, std::uint8_t* pixels)
{
  const Pairs pairs = loadPairs<kLayout>(row, i);
  const Simd::Vector blue = Simd::addIntegers(times(pairs.u, kBlueOfU), Simd::integers(kHalf - kNone * kBlueOfU));
  const Simd::Vector red = Simd::addIntegers(times(pairs.v, kRedOfV), Simd::integers(kHalf - kNone * kRedOfV));
  const Simd::Vector green = Simd::addIntegers(Simd::addIntegers(times(pairs.u, kGreenOfU), times(pairs.v, kGreenOfV)),
                                               Simd::integers(kHalf - kNone * (kGreenOfU + kGreenOfV)));
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
void colourRow(const YuvRow& row, int pairs, std::uint8_t* pixels)
{
  constexpr int kPairs = static_cast<int>(sizeof(Simd::Vector)) / 4;
  for (int i = 0; i + kPairs <= pairs; i += kPairs)
    colourPairs<kLayout, kRgb>(row, i, pixels);
  if (pairs % kPairs != 0) colourPairs<kLayout, kRgb>(row, pairs - kPairs, pixels);
}

template <YuvLayout kLayout>
void colourRow(const YuvRow& row, int pairs, bool is_rgb, std::uint8_t* pixels)
{
  (is_rgb ? colourRow<kLayout, true> : colourRow<kLayout, false>)(row, pairs, pixels);
}

void colourYuv(const YuvRow& row, YuvLayout layout, int pairs, bool is_rgb, std::uint8_t* pixels)
{
  switch (layout)
  {
    case YuvLayout::kYuyv:
      return colourRow<YuvLayout::kYuyv>(row, pairs, is_rgb, pixels);
    case YuvLayout::kUyvy:
      return colourRow<YuvLayout::kUyvy>(row, pairs, is_rgb, pixels);
    case YuvLayout::kUv:
      return colourRow<YuvLayout::kUv>(row, pairs, is_rgb, pixels);
    case YuvLayout::kVu:
      return colourRow<YuvLayout::kVu>(row, pairs, is_rgb, pixels);
    case YuvLayout::kPlanes:
      return colourRow<YuvLayout::kPlanes>(row, pairs, is_rgb, pixels);
  }
}

constexpr auto kColourYuv = colourYuv;

#else

constexpr decltype(YuvKernels::yuv) kColourYuv = nullptr;

#endif

}  // namespace

template <>
const YuvKernels KernelTable<YuvKernels, ROBOT_VISION_SET>::table = {
    everySecond,
    kColourYuv,
};

}  // namespace robot_vision
