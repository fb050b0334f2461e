#include "projection_kernels.hpp"

#include <cstdint>

#include "core/simd/kernel_numbers.hpp"

namespace robot_vision
{
namespace
{

constexpr float kNearest = 1e-3F;   // m
constexpr float kFarthest = 1e4F;   // m
constexpr float kFirst = -4096.0F;  // px: a position that is farther outside is taken for this one
constexpr float kLast = 20000.0F;   // px

struct Point
{
  float x, y;
};

/// atan(r) / r of s = r^2 <= 1 within 2e-8: Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.49.
ROBOT_VISION_INLINE float angleShare(float s)
{
  float sum = 0.0028662257F;
  sum = sum * s - 0.0161657367F;
  sum = sum * s + 0.0429096138F;
  sum = sum * s - 0.0752896400F;
  sum = sum * s + 0.1065626393F;
  sum = sum * s - 0.1420889944F;
  sum = sum * s + 0.1999355085F;
  sum = sum * s - 0.3333314528F;
  return sum * s + 1.0F;
}

template <LensKind kKind>
ROBOT_VISION_INLINE Point distorted(const Projection32& to, float x, float y)
{
  const float* const k = to.k;
  if constexpr (kKind == LensKind::kPinhole)
  {
    return {x, y};
  }
  else if constexpr (kKind == LensKind::kEquidistant)
  {
    constexpr float kRightAngle = 1.57079633F;
    const float s = x * x + y * y;
    const float inverse = 1.0F / greater(s, 1.0F);  // 1 within 45 degrees, where it is not used
    const float outer = kRightAngle * inverseRoot(greater(s, 1.0F)) - inverse * angleShare(inverse);
    const float share = s > 1.0F ? outer : angleShare(lesser(s, 1.0F));
    const float a2 = share * share * s;  // the square of the angle from the axis
    const float scale = share * (1.0F + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
    return {x * scale, y * scale};
  }
  else
  {
    const float r2 = x * x + y * y;
    float radial = 1.0F + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
    if constexpr (kKind == LensKind::kRational) radial = radial / (1.0F + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
    const float xy = 2.0F * x * y;
    return {x * radial + k[2] * xy + k[3] * (r2 + 2.0F * x * x), y * radial + k[2] * (r2 + 2.0F * y * y) + k[3] * xy};
  }
}

/// A position in px as steps, halves rounded up.
ROBOT_VISION_INLINE std::int32_t toSteps(float position)
{
  constexpr std::int32_t kPositive = 1 << 21;  // as what is negative would be rounded up, towards 0
  const float limited = lesser(greater(position, kFirst), kLast);
  return static_cast<std::int32_t>(limited * kSubpixels + (kPositive + 0.5F)) - kPositive;
}

template <LensKind kKind>
void projectRow(const float* depths, const RayRow& rays, const Projection32& to, int count, std::int32_t* __restrict u,
                std::int32_t* __restrict v, float* __restrict w)
{
  const RayRow row = rays;  // copies, which for the compiler cannot change by writes to the vertices
  const Projection32 by = to;
  const float* const r = by.rotation;
  const float max_r2 = by.max_radius * by.max_radius;
  for (int i = 0; i < count; ++i)
  {
    // One condition after the other: compilers make no vectors of all of these at once.
    const std::uint32_t depth_bits = bitsOf(depths[i]), ray_bits = bitsOf(row.x[i]);
    const std::uint32_t finite_bits = isPositive(depth_bits) ? depth_bits : 0;
    const float measured = fromBits(isFiniteNumber(ray_bits) ? finite_bits : 0);
    const float depth = measured < kFarthest ? measured : 0.0F;
    const float x = fromBits(isFiniteNumber(ray_bits) ? ray_bits : 0) * depth;
    const float y = fromBits(isFiniteNumber(ray_bits) ? bitsOf(row.y[i]) : 0) * depth;
    const float right = r[0] * x + r[1] * y + r[2] * depth + by.translation[0];
    const float down = r[3] * x + r[4] * y + r[5] * depth + by.translation[1];
    const float ahead = r[6] * x + r[7] * y + r[8] * depth + by.translation[2];
    const float z = depth > kNearest ? ahead : 0.0F;
    const float inverse = z > kNearest ? 1.0F / (z > kNearest ? z : 1.0F) : 0.0F;
    const float a = right * inverse, b = down * inverse, r2 = a * a + b * b;
    const Point at = distorted<kKind>(by, r2 <= max_r2 ? a : 0.0F, r2 <= max_r2 ? b : 0.0F);
    u[i] = toSteps(by.fx * at.x + by.skew * at.y + by.cx);
    v[i] = toSteps(by.fy * at.y + by.cy);
    w[i] = r2 <= max_r2 ? inverse : 0.0F;
  }
}

void project(const float* depths, const RayRow& rays, const Projection32& to, int count, std::int32_t* u,
             std::int32_t* v, float* w)
{
  switch (to.kind)
  {
    case LensKind::kPinhole:
      return projectRow<LensKind::kPinhole>(depths, rays, to, count, u, v, w);
    case LensKind::kPolynomial:
      return projectRow<LensKind::kPolynomial>(depths, rays, to, count, u, v, w);
    case LensKind::kRational:
      return projectRow<LensKind::kRational>(depths, rays, to, count, u, v, w);
    case LensKind::kEquidistant:
      return projectRow<LensKind::kEquidistant>(depths, rays, to, count, u, v, w);
  }
}

}  // namespace

template <>
const ProjectionKernels KernelTable<ProjectionKernels, ROBOT_VISION_SET>::table = {project};

}  // namespace robot_vision
