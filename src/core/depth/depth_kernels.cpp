#include "depth_kernels.hpp"

#include <cstdint>

#include "core/simd/kernel_numbers.hpp"

namespace robot_vision
{
namespace
{

void metresOf(const std::uint16_t* millimetres, int count, float* __restrict metres)
{
  for (int i = 0; i < count; ++i)
    metres[i] = valueIf(millimetres[i] != 0, static_cast<float>(millimetres[i]) / 1000.0F);
}

void depthsOf(const float* values, int count, float* depths)
{
  for (int i = 0; i < count; ++i)
    depths[i] = valueIf(isPositive(bitsOf(values[i])), values[i]);
}

void millimetresOf(const float* depths, int count, std::uint16_t* __restrict millimetres)
{
  constexpr float kBeyond = 65536.0F;
  for (int i = 0; i < count; ++i)
  {
    const bool is_depth = isPositive(bitsOf(depths[i]));
    const float rounded = fromBits(is_depth ? bitsOf(depths[i]) : 0) * 1000.0F + 0.5F;
    const float limited = rounded < kBeyond ? rounded : 0.0F;
    millimetres[i] = static_cast<std::uint16_t>(static_cast<std::int32_t>(limited));
  }
}

void inversesOf(const float* depths, const float* rays, int count, float* __restrict inverses)
{
  constexpr float kNearest = 1e-4F;  // m; the inverses of smaller floats need not be finite
  for (int i = 0; i < count; ++i)
  {
    const bool is_depth = isPositive(bitsOf(depths[i])) & isFiniteNumber(bitsOf(rays[i]));
    const float depth = fromBits(is_depth ? bitsOf(depths[i]) : 0);
    const bool seen = depth > kNearest;
    const float inverse = 1.0F / (seen ? depth : 1.0F);
    inverses[i] = seen ? inverse : 0.0F;
  }
}

/// Writes x, y and z of pixel `i`.
inline void writePoint(const float* depths, const float* xs, const float* ys, int i, float* point)
{
  const bool seen = isPositive(bitsOf(depths[i])) & isFiniteNumber(bitsOf(xs[i]));
  const float z = fromBits(seen ? bitsOf(depths[i]) : 0);
  const float x = fromBits(seen ? bitsOf(xs[i]) : 0) * z;
  const float y = fromBits(seen ? bitsOf(ys[i]) : 0) * z;
  point[0] = valueIf(seen, x);
  point[1] = valueIf(seen, y);
  point[2] = valueIf(seen, z);
}

void pointsOf(const float* depths, const RayRow& rays, int count, float* __restrict points)
{
  const RayRow row = rays;  // a copy, which for the compiler cannot change by writes to `points`
  for (int i = 0; i < count; ++i)
    writePoint(depths, row.x, row.y, i, points + 3 * i);
}

void paddedPointsOf(const float* depths, const RayRow& rays, int count, float* __restrict points)
{
  const RayRow row = rays;
  for (int i = 0; i < count; ++i)
  {
    writePoint(depths, row.x, row.y, i, points + 4 * i);
    points[4 * i + 3] = 1.0F;
  }
}

void coloredPointsOf(const float* depths, const RayRow& rays, const std::uint8_t* bgr, int count,
                     float* __restrict points)
{
  const RayRow row = rays;
  for (int i = 0; i < count; ++i)
  {
    writePoint(depths, row.x, row.y, i, points + 4 * i);
    const std::uint32_t blue = bgr[3 * i], green = bgr[3 * i + 1], red = bgr[3 * i + 2];
    points[4 * i + 3] = fromBits(red << 16 | green << 8 | blue);
  }
}

}  // namespace

template <>
const DepthKernels KernelTable<DepthKernels, ROBOT_VISION_SET>::table = {
    metresOf, depthsOf, millimetresOf, inversesOf, pointsOf, paddedPointsOf, coloredPointsOf,
};

}  // namespace robot_vision
