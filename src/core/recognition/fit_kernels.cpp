#include "fit_kernels.hpp"

#include "core/simd/kernel_numbers.hpp"

namespace robot_vision
{
namespace
{

constexpr float kNearest = 0.02F;  // m, in front of the camera
constexpr float kFar = 16384.0F;   // px, from the image

/// A row of a rotation times a vector.
struct Row
{
  float x, y, z;

  ROBOT_VISION_INLINE float times(float a, float b, float c) const { return x * a + y * b + z * c; }
};

void placesOf(const FitPoints& points, int count, const FitPose& pose, float* __restrict x, float* __restrict y,
              float* __restrict z)
{
  const float* const r = pose.rotation;
  const Row first{r[0], r[1], r[2]}, second{r[3], r[4], r[5]}, third{r[6], r[7], r[8]};
  const float ax = pose.anchor[0], ay = pose.anchor[1], az = pose.anchor[2];
  const float *const px = points.x, *const py = points.y, *const pz = points.z;
  for (int i = 0; i < count; ++i)
  {
    x[i] = first.times(px[i], py[i], pz[i]) + ax;
    y[i] = second.times(px[i], py[i], pz[i]) + ay;
    z[i] = third.times(px[i], py[i], pz[i]) + az;
  }
}

void pixelsOf(const float* x, const float* y, const float* z, int count, const FitCamera& from,
              float* __restrict inverse, std::int32_t* __restrict u, std::int32_t* __restrict v)
{
  const FitCamera camera = from;
  for (int i = 0; i < count; ++i)
  {
    const float w = 1.0F / greater(z[i], kNearest);
    const float across = x[i] * w * camera.fx + camera.cx, down = y[i] * w * camera.fy + camera.cy;
    // Rounded above 0, where numbers are rounded down.
    const float column = lesser(greater(across, -kFar), kFar) + (kFar + 0.5F);
    const float row = lesser(greater(down, -kFar), kFar) + (kFar + 0.5F);
    const std::int32_t c = static_cast<std::int32_t>(column) - static_cast<std::int32_t>(kFar);
    const std::int32_t r = static_cast<std::int32_t>(row) - static_cast<std::int32_t>(kFar);
    const bool inside = (z[i] > kNearest) & (c >= 0) & (r >= 0) & (c < static_cast<std::int32_t>(camera.width)) &
                        (r < static_cast<std::int32_t>(camera.height));
    inverse[i] = w;
    u[i] = inside ? c : -1;
    v[i] = inside ? r : 0;
  }
}

void project(const FitPoints& points, int count, const FitPose& pose, const FitCamera& camera, const SeenPoints& seen)
{
  FitPose turn = pose;
  turn.anchor[0] = turn.anchor[1] = turn.anchor[2] = 0.0F;
  const FitPoints normals{points.nx, points.ny, points.nz, nullptr, nullptr, nullptr};
  placesOf(points, count, pose, seen.x, seen.y, seen.z);
  placesOf(normals, count, turn, seen.nx, seen.ny, seen.nz);
  pixelsOf(seen.x, seen.y, seen.z, count, camera, seen.inverse, seen.u, seen.v);
}

}  // namespace

template <>
const FitKernels KernelTable<FitKernels, ROBOT_VISION_SET>::table = {project};

}  // namespace robot_vision
