#include "vertex_kernels.hpp"

#include <cfloat>

namespace robot_vision
{
namespace
{

constexpr int kBlock = 64;  // vertices that are computed in rows, for vectors, before they are put together

SeenBounds transform(const float* const* points, int count, const double* matrix, SeenVertex* seen)
{
  double m[12];
  for (int i = 0; i < 12; ++i)
    m[i] = matrix[i];
  double min_w = DBL_MAX, min_u = DBL_MAX, max_u = -DBL_MAX, min_v = DBL_MAX, max_v = -DBL_MAX;
  for (int begin = 0; begin < count; begin += kBlock)
  {
    double xs[kBlock], ys[kBlock], ws[kBlock], us[kBlock], vs[kBlock];
    const int number = count - begin < kBlock ? count - begin : kBlock;
    for (int i = 0; i < number; ++i)
    {
      const double x = points[0][begin + i], y = points[1][begin + i], z = points[2][begin + i];
      xs[i] = m[0] * x + m[1] * y + m[2] * z + m[3];
      ys[i] = m[4] * x + m[5] * y + m[6] * z + m[7];
      ws[i] = m[8] * x + m[9] * y + m[10] * z + m[11];
      us[i] = xs[i] / ws[i];
      vs[i] = ys[i] / ws[i];
      min_w = ws[i] < min_w ? ws[i] : min_w;
      min_u = us[i] < min_u ? us[i] : min_u;
      max_u = us[i] > max_u ? us[i] : max_u;
      min_v = vs[i] < min_v ? vs[i] : min_v;
      max_v = vs[i] > max_v ? vs[i] : max_v;
    }
    for (int i = 0; i < number; ++i)
      seen[begin + i] = {xs[i], ys[i], ws[i], static_cast<float>(us[i]), static_cast<float>(vs[i])};
  }
  return {min_w, min_u, max_u, min_v, max_v};
}

void rotate(const float* const* vectors, int count, const float* matrix, float* rotated)
{
  float m[9];
  for (int i = 0; i < 9; ++i)
    m[i] = matrix[i];
  for (int i = 0; i < count; ++i)
  {
    const float x = vectors[0][i], y = vectors[1][i], z = vectors[2][i];
    rotated[3 * i] = m[0] * x + m[1] * y + m[2] * z;
    rotated[3 * i + 1] = m[3] * x + m[4] * y + m[5] * z;
    rotated[3 * i + 2] = m[6] * x + m[7] * y + m[8] * z;
  }
}

int facing(const float* const* planes, int count, const float* point, int* found)
{
  const float x = point[0], y = point[1], z = point[2];
  int number = 0;
  for (int i = 0; i < count; ++i)
  {
    const float distance = planes[0][i] * x + planes[1][i] * y + planes[2][i] * z + planes[3][i];
    found[number] = i;
    number += distance > 0.0F;
  }
  return number;
}

}  // namespace

template <>
const VertexKernels KernelTable<VertexKernels, ROBOT_VISION_SET>::table = {transform, rotate, facing};

}  // namespace robot_vision
