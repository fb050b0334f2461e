#include "derivative_kernels.hpp"

namespace robot_vision
{
namespace
{

template <int kTaps>
void sumRowsOf(const std::uint8_t* const* rows, const std::int16_t* weights, int count, std::int16_t* __restrict sums)
{
  const std::uint8_t* row[kTaps];
  std::int16_t weight[kTaps];
  for (int k = 0; k < kTaps; ++k)
  {
    row[k] = rows[k];
    weight[k] = weights[k];
  }
  for (int i = 0; i < count; ++i)
  {
    std::int16_t sum = 0;
    for (int k = 0; k < kTaps; ++k)
      sum = static_cast<std::int16_t>(sum + row[k][i] * weight[k]);
    sums[i] = sum;
  }
}

template <int kTaps>
void magnitudesOf(const std::int16_t* sums, const std::int16_t* weights, int channels, int count,
                  std::uint8_t* __restrict magnitudes)
{
  const std::int16_t* shifted[kTaps];
  std::int16_t weight[kTaps];
  for (int k = 0; k < kTaps; ++k)
  {
    shifted[k] = sums + (k - kTaps / 2) * channels;
    weight[k] = weights[k];
  }
  for (int i = 0; i < count; ++i)
  {
    std::int16_t sum = 0;
    for (int k = 0; k < kTaps; ++k)
      sum = static_cast<std::int16_t>(sum + shifted[k][i] * weight[k]);
    const auto magnitude = static_cast<std::int16_t>(sum < 0 ? -sum : sum);
    magnitudes[i] = static_cast<std::uint8_t>(magnitude < 255 ? magnitude : 255);
  }
}

void sumRows(const std::uint8_t* const* rows, const std::int16_t* weights, int taps, int count, std::int16_t* sums)
{
  if (taps == 3)
    sumRowsOf<3>(rows, weights, count, sums);
  else
    sumRowsOf<5>(rows, weights, count, sums);
}

void findMagnitudes(const std::int16_t* sums, const std::int16_t* weights, int taps, int channels, int count,
                    std::uint8_t* magnitudes)
{
  if (taps == 3)
    magnitudesOf<3>(sums, weights, channels, count, magnitudes);
  else
    magnitudesOf<5>(sums, weights, channels, count, magnitudes);
}

}  // namespace

template <>
const DerivativeKernels KernelTable<DerivativeKernels, ROBOT_VISION_SET>::table = {
    sumRows,
    findMagnitudes,
};

}  // namespace robot_vision
