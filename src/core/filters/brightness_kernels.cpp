#include "brightness_kernels.hpp"

#include <cstdint>

namespace robot_vision
{
namespace
{

void applyLine(const std::uint8_t* __restrict values, float gain, float offset, int count,
               std::uint8_t* __restrict results)
{
  constexpr float kTwo23 = 8388608.0F;  // 2^23: a float this large has no fractional bits, so that adding it rounds
  for (int i = 0; i < count; ++i)
  {
    const float value = static_cast<float>(values[i]) * gain + offset;
    const float positive = value > 0.0F ? value : 0.0F;
    const float limited = positive < 255.0F ? positive : 255.0F;
    results[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>((limited + kTwo23) - kTwo23));
  }
}

}  // namespace

template <>
const BrightnessKernels KernelTable<BrightnessKernels, ROBOT_VISION_SET>::table = {
    applyLine,
};

}  // namespace robot_vision
