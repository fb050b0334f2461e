#include "threshold_kernels.hpp"

namespace robot_vision
{
namespace
{

void compareWithMean(const std::uint8_t* values, int difference, int inversion, int count,
                     std::uint8_t* __restrict means)
{
  const auto limit = static_cast<std::int16_t>(difference);
  const auto flip = static_cast<std::uint8_t>(inversion);
  for (int i = 0; i < count; ++i)
  {
    const auto above = static_cast<std::int16_t>(values[i] - means[i]);
    means[i] = static_cast<std::uint8_t>((above > limit ? 255 : 0) ^ flip);
  }
}

}  // namespace

template <>
const ThresholdKernels KernelTable<ThresholdKernels, ROBOT_VISION_SET>::table = {
    compareWithMean,
};

}  // namespace robot_vision
