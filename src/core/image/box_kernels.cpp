#include "box_kernels.hpp"

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

// Stands before a loop that may be vectorized although the memory that it writes overlaps the memory that it reads.
#ifdef __clang__
#define ROBOT_VISION_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define ROBOT_VISION_INDEPENDENT _Pragma("GCC ivdep")
#endif

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

void divide(const std::uint16_t* __restrict sums, const BoxDivision& by, int count, std::uint8_t* __restrict quotients)
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

void divide(const std::uint32_t* __restrict sums, const BoxDivision& by, int count, std::uint8_t* __restrict quotients)
{
  const float reciprocal = by.reciprocal;
  for (int i = 0; i < count; ++i)  // converts by way of int, for which more SIMD instructions exist
  {
    const auto sum = static_cast<float>(static_cast<std::int32_t>(sums[i]));
    quotients[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>(sum * reciprocal + 0.5F));
  }
}

}  // namespace

template <>
const BoxKernels<std::uint16_t> KernelTable<BoxKernels<std::uint16_t>, ROBOT_VISION_SET>::table = {
    slide,
    widen,
    divide,
};

template <>
const BoxKernels<std::uint32_t> KernelTable<BoxKernels<std::uint32_t>, ROBOT_VISION_SET>::table = {
    slide,
    widen,
    divide,
};

}  // namespace robot_vision
