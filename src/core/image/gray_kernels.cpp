#include "gray_kernels.hpp"

#include <cstdint>
#include <cstring>

#include "core/simd/pixel_vectors.hpp"

namespace robot_vision
{
namespace
{

#ifdef ROBOT_VISION_PIXELS

#ifdef __AVX512VNNI__

/// Computes the gray values of as many pixels as a vector has integers.
class GrayMean
{
public:
  explicit GrayMean(const GrayWeights& weights)
    : upper_(bytesOf(weights, upperByte)),
      lower_(bytesOf(weights, lowerByte)),
      half_(Simd::integers(1 << (weights.shift - 1))),
      shift_(weights.shift)
  {
  }

  Simd::Vector operator()(Simd::Vector pixels) const
  {
    const Simd::Vector upper = _mm512_dpbusd_epi32(Simd::zeros(), pixels, upper_);
    const Simd::Vector sum = Simd::addIntegers(_mm512_slli_epi32(upper, 8), half_);
    return PixelSimd::shiftIntegers(_mm512_dpbusd_epi32(sum, pixels, lower_), shift_);
  }

private:
  // The product of bytes takes signed bytes only, so that a weight is split into two: 256 * upper + lower.
  static int upperByte(int weight) { return (weight + 128) >> 8; }
  static int lowerByte(int weight) { return (weight - 256 * upperByte(weight)) & 0xFF; }

  template <class Byte>
  static Simd::Vector bytesOf(const GrayWeights& weights, const Byte& byte)
  {
    return Simd::integers(byte(weights.channels[0]) | byte(weights.channels[1]) << 8 | byte(weights.channels[2]) << 16);
  }

  Simd::Vector upper_;
  Simd::Vector lower_;
  Simd::Vector half_;
  int shift_;
};

#else

class GrayMean
{
public:
  explicit GrayMean(const GrayWeights& weights)
    : outer_(Simd::integers(weights.channels[0] | weights.channels[2] << 16)),
      middle_(Simd::integers(weights.channels[1])),
      half_(Simd::integers(1 << (weights.shift - 1))),
      shift_(weights.shift)
  {
  }

  Simd::Vector operator()(Simd::Vector pixels) const
  {
    const Simd::Vector outer = Simd::And(pixels, Simd::integers(0x00FF00FF));
    const Simd::Vector middle = PixelSimd::upperBytes(pixels);
    const Simd::Vector sum = Simd::addWordPairs(Simd::addWordPairs(half_, outer, outer_), middle, middle_);
    return PixelSimd::shiftIntegers(sum, shift_);
  }

private:
  Simd::Vector outer_;
  Simd::Vector middle_;
  Simd::Vector half_;
  int shift_;
};

#endif

/// Converts as many pixels as a vector has bytes.
template <int kChannels>
void grayBlock(const std::uint8_t* pixels, const GrayMean& mean, std::uint8_t* gray)
{
  constexpr int kStep = kChannels * static_cast<int>(sizeof(Simd::Vector)) / 4;
  const Simd::Vector first = mean(loadPixels<kChannels>(pixels));
  const Simd::Vector second = mean(loadPixels<kChannels>(pixels + kStep));
  const Simd::Vector third = mean(loadPixels<kChannels>(pixels + 2 * kStep));
  const Simd::Vector fourth = mean(loadPixels<kChannels>(pixels + 3 * kStep));
  PixelSimd::storeIntegersAsBytes(gray, first, second, third, fourth);
}

template <int kChannels>
void grayRow(const std::uint8_t* pixels, const GrayMean& mean, int count, std::uint8_t* gray)
{
  constexpr int kPixels = static_cast<int>(sizeof(Simd::Vector));
  std::uint8_t rest[kChannels * kPixels] = {};  // room for the last block, which would be read beyond the row's end
  std::uint8_t gray_rest[kPixels];
  for (int i = 0; i < count; i += kPixels)
  {
    const auto left = static_cast<std::size_t>(count - i);
    const bool whole = left >= kPixels;
    if (!whole) std::memcpy(rest, pixels + kChannels * i, kChannels * left);
    grayBlock<kChannels>(whole ? pixels + kChannels * i : rest, mean, whole ? gray + i : gray_rest);
    if (!whole) std::memcpy(gray + i, gray_rest, left);
  }
}

void convertToGray(const std::uint8_t* pixels, int channels, const GrayWeights& weights, int count, std::uint8_t* gray)
{
  const GrayMean mean(weights);
  if (channels == 3)
    grayRow<3>(pixels, mean, count, gray);
  else
    grayRow<4>(pixels, mean, count, gray);
}

#else

constexpr decltype(GrayKernels::gray) convertToGray = nullptr;

#endif

}  // namespace

template <>
const GrayKernels KernelTable<GrayKernels, ROBOT_VISION_SET>::table = {
    convertToGray,
};

}  // namespace robot_vision
