#include "box_kernels.hpp"

namespace robot_vision
{

BoxDivision::BoxDivision(int divisor)
  : half(static_cast<std::uint16_t>(divisor / 2)), factor(0), shift(0), reciprocal(1.0F / static_cast<float>(divisor))
{
  while (2 << shift <= divisor)
    ++shift;
  const std::uint32_t one = 1U << (16 + shift);
  factor = static_cast<std::uint16_t>((one + static_cast<std::uint32_t>(divisor) - 1) / divisor);
}

}  // namespace robot_vision
