#include "tile_kernels.hpp"

namespace robot_vision
{
namespace
{

void interpolate(const TileRows& rows, const float* left, const float* right, float upper, float lower, int count,
                 std::uint8_t* __restrict values)
{
  constexpr float kTwo23 = 8388608.0F;  // 2^23: a float this large has no fractional bits, so that adding it rounds
  for (int i = 0; i < count; ++i)
  {
    const float above =
        static_cast<float>(rows.upper_left[i]) * left[i] + static_cast<float>(rows.upper_right[i]) * right[i];
    const float below =
        static_cast<float>(rows.lower_left[i]) * left[i] + static_cast<float>(rows.lower_right[i]) * right[i];
    const float value = above * upper + below * lower;
    values[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>((value + kTwo23) - kTwo23));
  }
}

}  // namespace

template <>
const TileKernels KernelTable<TileKernels, ROBOT_VISION_SET>::table = {
    interpolate,
};

}  // namespace robot_vision
