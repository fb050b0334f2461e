#include "pyramid_kernels.hpp"

#include <cstring>

namespace robot_vision
{
namespace
{

void sumRows(const std::uint8_t* const* rows, int count, std::uint16_t* __restrict sums)
{
  const std::uint8_t* const row[] = {rows[0], rows[1], rows[2], rows[3], rows[4]};
  for (int i = 0; i < count; ++i)
    sums[i] = static_cast<std::uint16_t>(row[0][i] + row[4][i] + 4 * (row[1][i] + row[3][i]) + 6 * row[2][i]);
}

void blurRow(const std::uint16_t* sums, int channels, int count, std::uint8_t* __restrict blurred)
{
  const std::uint16_t* const shifted[] = {sums - 2 * channels, sums - channels, sums, sums + channels,
                                          sums + 2 * channels};
  for (int i = 0; i < count; ++i)
  {
    // It fits 16 bits: 256 * 255 + 128.
    const auto ends = static_cast<std::uint16_t>(shifted[0][i] + shifted[4][i] + 128);
    const auto beside = static_cast<std::uint16_t>(shifted[1][i] + shifted[3][i]);
    const auto sum = static_cast<std::uint16_t>(ends + 4 * beside + 6 * shifted[2][i]);
    blurred[i] = static_cast<std::uint8_t>(sum >> 8);
  }
}

/// Copies every other pixel of kChannels bytes. The last one is copied by itself, as the others are as four bytes.
template <int kChannels>
void takeEveryOther(const std::uint8_t* __restrict from, int pixels, std::uint8_t* __restrict to)
{
  const int last = (pixels - 1) / 2;
  for (int i = 0; i < last; ++i)
    std::memcpy(to + kChannels * i, from + 2 * kChannels * i, kChannels == 3 ? 4 : kChannels);
  std::memcpy(to + kChannels * last, from + 2 * kChannels * last, kChannels);
}

void halveRow(const std::uint16_t* sums, int channels, int pixels, std::uint8_t* blurred, std::uint8_t* halved)
{
  blurRow(sums, channels, pixels * channels, blurred);
  switch (channels)
  {
    case 1:
      return takeEveryOther<1>(blurred, pixels, halved);
    case 2:
      return takeEveryOther<2>(blurred, pixels, halved);
    case 3:
      return takeEveryOther<3>(blurred, pixels, halved);
    default:
      return takeEveryOther<4>(blurred, pixels, halved);
  }
}

}  // namespace

template <>
const PyramidKernels KernelTable<PyramidKernels, ROBOT_VISION_SET>::table = {
    sumRows,
    halveRow,
};

}  // namespace robot_vision
