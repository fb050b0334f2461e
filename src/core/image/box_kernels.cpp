#include "box_kernels.hpp"

#include "core/simd/loops.hpp"

namespace robot_vision
{
namespace
{

template <class Sum>
void slide(const std::uint8_t* entering, const std::uint8_t* leaving, int count, Sum* __restrict sums)
{
  for (int i = 0; i < count; ++i)
    sums[i] = static_cast<Sum>(sums[i] + entering[i] - leaving[i]);
}

template <class Sum>
void widen(const Sum* single, const Sum* part, int width, bool odd, int count, Sum* wider)
{
  // `wider` may be `part`: each element is read before it is overwritten, in the same or an earlier iteration.
  if (odd)
  {
    ROBOT_VISION_INDEPENDENT
    for (int i = 0; i < count; ++i)
      wider[i] = static_cast<Sum>(part[i] + part[i + width] + single[i + 2 * width]);
  }
  else
  {
    ROBOT_VISION_INDEPENDENT
    for (int i = 0; i < count; ++i)
      wider[i] = static_cast<Sum>(part[i] + part[i + width]);
  }
}

void divide16(const std::uint16_t* __restrict sums, const Division& by, int count, std::uint8_t* __restrict quotients)
{
  const std::uint16_t half = by.half;
  const std::uint16_t factor = by.factor;
  const int shift = by.shift;
  for (int i = 0; i < count; ++i)
  {
    const auto sum = static_cast<std::uint16_t>(sums[i] + half);
    const auto high = static_cast<std::uint16_t>(std::uint32_t{sum} * factor >> 16);  // a single SIMD instruction
    quotients[i] = static_cast<std::uint8_t>(high >> shift);
  }
}

void divide32(const std::uint32_t* __restrict sums, float factor, int count, std::uint8_t* __restrict quotients)
{
  for (int i = 0; i < count; ++i)  // converts by way of int, for which more SIMD instructions exist
  {
    const auto sum = static_cast<float>(static_cast<std::int32_t>(sums[i]));
    quotients[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>(sum * factor + 0.5F));
  }
}

}  // namespace

template <>
const BoxKernels KernelTable<BoxKernels, ROBOT_VISION_SET>::table = {
    slide<std::uint16_t>, slide<std::uint32_t>, widen<std::uint16_t>, widen<std::uint32_t>, divide16, divide32,
};

}  // namespace robot_vision
