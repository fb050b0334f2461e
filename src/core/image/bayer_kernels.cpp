#include "bayer_kernels.hpp"

#include <cstdint>

#include "core/simd/pixel_vectors.hpp"

namespace robot_vision
{
namespace
{

#ifdef ROBOT_VISION_PIXELS

/// (a + b + c + d + 2) / 4, computed from the rounded means of a and b and of c and d. The mean of the two means is 1
/// too large where both steps have rounded up.
inline Simd::Vector meanOfMeans(Simd::Vector ab, Simd::Vector odd_ab, Simd::Vector cd, Simd::Vector odd_cd)
{
  const Simd::Vector rounded = Simd::And(Simd::Or(odd_ab, odd_cd), PixelSimd::Xor(ab, cd));
  return PixelSimd::subtractBytes(PixelSimd::meanBytes(ab, cd), Simd::And(rounded, PixelSimd::bytes(1)));
}

/// Converts the pixels from `i` on. `sites` has ones in the bytes of those that are not green.
inline void convertBlock(const BayerRow& row, int i, Simd::Vector sites, bool third, std::uint8_t* pixels)
{
  const Simd::Vector pixel = Simd::load(row.row + i);
  const Simd::Vector left = Simd::load(row.row + i - 1);
  const Simd::Vector right = Simd::load(row.row + i + 1);
  const Simd::Vector above = Simd::load(row.above + i);
  const Simd::Vector below = Simd::load(row.below + i);
  const Simd::Vector above_left = Simd::load(row.above + i - 1);
  const Simd::Vector above_right = Simd::load(row.above + i + 1);
  const Simd::Vector below_left = Simd::load(row.below + i - 1);
  const Simd::Vector below_right = Simd::load(row.below + i + 1);
  const Simd::Vector beside = PixelSimd::meanBytes(left, right);
  const Simd::Vector over = PixelSimd::meanBytes(above, below);
  const Simd::Vector four = meanOfMeans(beside, PixelSimd::Xor(left, right), over, PixelSimd::Xor(above, below));
  const Simd::Vector corners =
      meanOfMeans(PixelSimd::meanBytes(above_left, above_right), PixelSimd::Xor(above_left, above_right),
                  PixelSimd::meanBytes(below_left, below_right), PixelSimd::Xor(below_left, below_right));
  const Simd::Vector own = PixelSimd::selectBits(sites, pixel, beside);
  const Simd::Vector green = PixelSimd::selectBits(sites, four, pixel);
  const Simd::Vector other = PixelSimd::selectBits(sites, corners, over);
  StoreInterleaved3(pixels + 3 * i, {third ? other : own, green, third ? own : other});
}

void convertBayer(const BayerRow& row, int count, std::uint8_t* pixels)
{
  constexpr int kBytes = static_cast<int>(sizeof(Simd::Vector));
  const Simd::Vector sites = Simd::words(row.green_first ? 0xFF00 : 0x00FF);
  int i = 0;
  for (; i + kBytes <= count; i += kBytes)
    convertBlock(row, i, sites, row.third, pixels);
  if (i == count) return;
  i = count - kBytes;
  convertBlock(row, i, Simd::words((i % 2 != 0) != row.green_first ? 0xFF00 : 0x00FF), row.third, pixels);
}

#else

constexpr decltype(BayerKernels::bayer) convertBayer = nullptr;

#endif

}  // namespace

template <>
const BayerKernels KernelTable<BayerKernels, ROBOT_VISION_SET>::table = {
    convertBayer,
};

}  // namespace robot_vision
