#include "frame_kernels.hpp"

#include <utility>

#include "core/simd/kernel_numbers.hpp"

namespace robot_vision
{
namespace
{

constexpr int kSectorCount = 7;
// Tangents of the angles between normal and ray, squared: 27 and 18 degrees.
constexpr float kMaxFacing = 0.2596162F;
constexpr float kMinLeaning = 0.1055728F;
// Cosine of the half of a sector with its margin, 34.714 degrees, squared.
constexpr float kSectorCosine = 0.6756814F;
constexpr float kSectorX[kSectorCount] = {1.0F,         0.62348980F,  -0.22252093F, -0.90096887F,
                                          -0.90096887F, -0.22252093F, 0.62348980F};
constexpr float kSectorY[kSectorCount] = {0.0F,         0.78183148F,  0.97492791F, 0.43388374F,
                                          -0.43388374F, -0.97492791F, -0.78183148F};
// Tangents of 11.25, 22.5, ... 78.75 degrees, in 4096ths of the cosine and the sine.
constexpr std::int32_t kOctantCosine[7] = {4017, 3784, 3406, 2896, 2276, 1567, 799};
constexpr std::int32_t kOctantSine[7] = {799, 1567, 2276, 2896, 3406, 3784, 4017};

void inversesOfMillimetres(const std::uint16_t* millimetres, int count, float* __restrict inverses)
{
  for (int i = 0; i < count; ++i)
  {
    const auto z = static_cast<float>(static_cast<std::int32_t>(millimetres[i]));
    inverses[i] = z > 0.0F ? 1000.0F / (z > 0.0F ? z : 1.0F) : 0.0F;
  }
}

void inversesOfMetres(const float* metres, int count, float* __restrict inverses)
{
  constexpr float kMin = 1e-3F, kMax = 1e3F;  // m
  for (int i = 0; i < count; ++i)
  {
    const bool finite = isPositive(bitsOf(metres[i]));
    const float z = finite ? metres[i] : kMax;
    const bool there = finite & (z >= kMin) & (z <= kMax);
    inverses[i] = there ? 1.0F / (there ? z : 1.0F) : 0.0F;
  }
}

template <int kBlock>
void nearest(const float* const* rows, int count, float* __restrict inverses)
{
  const float* from[kBlock];
  for (int k = 0; k < kBlock; ++k)
    from[k] = rows[k];
  for (int i = 0; i < count; ++i)
  {
    float largest = 0.0F;
    for (int k = 0; k < kBlock; ++k)
      for (int j = 0; j < kBlock; ++j)
        largest = greater(largest, from[k][i * kBlock + j]);
    const float least = largest * (1.0F - kOneSurface);
    float sum = 0.0F, number = 0.0F;
    for (int k = 0; k < kBlock; ++k)
      for (int j = 0; j < kBlock; ++j)
      {
        const bool same = from[k][i * kBlock + j] >= least;
        sum += same ? from[k][i * kBlock + j] : 0.0F;
        number += same ? 1.0F : 0.0F;
      }
    inverses[i] = sum / number;
  }
}

/// Sums over neighbours of one surface, for the least squares of its slopes.
struct SlopeSums
{
  float uu = 0.0F, uv = 0.0F, vv = 0.0F, ud = 0.0F, vd = 0.0F;

  ROBOT_VISION_INLINE void add(float u, float v, float difference, float tolerance)
  {
    const bool same = greater(difference, -difference) <= tolerance;
    uu += same ? u * u : 0.0F;
    uv += same ? u * v : 0.0F;
    vv += same ? v * v : 0.0F;
    ud += same ? u * difference : 0.0F;
    vd += same ? v * difference : 0.0F;
  }
};

ROBOT_VISION_INLINE std::uint8_t bit(bool set, int number)
{
  return static_cast<std::uint8_t>(set ? 1 << number : 0);
}

// What is done for several k is straight code, made by these sequences: a loop inside the one over the pixels would
// keep that from making vectors.
using Sectors = std::make_integer_sequence<int, kSectorCount>;
using Octants = std::make_integer_sequence<int, 7>;
using Ring = std::make_integer_sequence<int, 5>;

template <int... k>
ROBOT_VISION_INLINE std::uint8_t sectorBins(float x, float y, float leaning, std::integer_sequence<int, k...> /*all*/)
{
  const auto sector = [=](int number, float along)
  { return bit((along > 0.0F) & (along * along >= kSectorCosine * leaning), number + 1); };
  return static_cast<std::uint8_t>((sector(k, x * kSectorX[k] + y * kSectorY[k]) | ...));
}

/// `x` and `y` of a normal in the frame of its ray, of which `facing` is the component along the ray; of any length.
ROBOT_VISION_INLINE std::uint8_t surfaceBins(float x, float y, float facing)
{
  const float leaning = x * x + y * y, front = facing * facing;
  const std::uint8_t sectors = sectorBins(x, y, leaning, Sectors());
  const std::uint8_t leans = leaning >= kMinLeaning * front ? sectors : std::uint8_t{0};
  return static_cast<std::uint8_t>(leans | bit(leaning <= kMaxFacing * front, 0));
}

/// Of one side of a square of 5 x 5.
template <int... k>
ROBOT_VISION_INLINE void addSide(SlopeSums& sums, const float* row, float v, float w, float tolerance,
                                 std::integer_sequence<int, k...> /*five*/)
{
  (sums.add(static_cast<float>(k - 2), v, row[k - 2] - w, tolerance), ...);
}

ROBOT_VISION_INLINE void addEnds(SlopeSums& sums, const float* row, float v, float w, float tolerance)
{
  sums.add(-2.0F, v, row[-2] - w, tolerance);
  sums.add(2.0F, v, row[2] - w, tolerance);
}

void slopesOf(const float* const* rows, const RayGeometry& rays, int count, float* __restrict across,
              float* __restrict along, std::uint8_t* __restrict bins)
{
  // Of the 16 pixels around a square of 3 x 3 all but one in eight have nearly all of the information.
  constexpr float kMinDeterminant = 100.0F;
  const float *const r0 = rows[0], *const r1 = rows[1], *const r2 = rows[2], *const r3 = rows[3], *const r4 = rows[4];
  const float *const ray_x = rays.x, *const inverse_lengths = rays.inverse_lengths;
  const float ray_y = rays.y, fx = rays.fx, fy = rays.fy;
  for (int i = 0; i < count; ++i)
  {
    const float w = r2[i], tolerance = w * kOneSurface;
    SlopeSums sums;
    addSide(sums, r0 + i, -2.0F, w, tolerance, Ring());
    addEnds(sums, r1 + i, -1.0F, w, tolerance);
    addEnds(sums, r2 + i, 0.0F, w, tolerance);
    addEnds(sums, r3 + i, 1.0F, w, tolerance);
    addSide(sums, r4 + i, 2.0F, w, tolerance, Ring());
    const float determinant = sums.uu * sums.vv - sums.uv * sums.uv;
    const bool there = (w > 0.0F) & (determinant >= kMinDeterminant);
    const float inverse = 1.0F / (there ? determinant : 1.0F);
    const float a = fx * (sums.vv * sums.ud - sums.uv * sums.vd) * inverse;
    const float b = fy * (sums.uu * sums.vd - sums.uv * sums.ud) * inverse;
    across[i] = there ? a : 0.0F;
    along[i] = there ? b : 0.0F;
    // The normal is -(a, b, c). It is seen in the frame that the shortest turn brings from the axis to the ray.
    const float x = ray_x[i], length = inverse_lengths[i];
    const float c = w - x * a - ray_y * b, facing = w * length;
    const float share = (facing + c) / (1.0F + length) * length;
    const std::uint8_t found = surfaceBins(share * x - a, share * ray_y - b, facing);
    bins[i] = there ? found : std::uint8_t{0};
  }
}

void slopes(const float* const* rows, const RayGeometry& rays, int count, const SlopeRow& slopes)
{
  slopesOf(rows, rays, count, slopes.across, slopes.along, slopes.bins);
}

/// The half bin of the direction of (x, y), whatever its sign.
template <int... k>
ROBOT_VISION_INLINE std::int32_t octantOf(std::int32_t x, std::int32_t y, std::integer_sequence<int, k...> /*all*/)
{
  const std::int32_t ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
  const std::int32_t octant = ((ay * kOctantCosine[k] >= ax * kOctantSine[k] ? 1 : 0) + ...);
  return (x < 0) != (y < 0) ? 15 - octant : octant;
}

/// Its bin and the one that it is next to.
ROBOT_VISION_INLINE std::uint8_t edgeBins(std::int32_t octant)
{
  const std::int32_t bin = octant >> 1, next = (octant & 1) != 0 ? bin + 1 : bin + 7;
  return static_cast<std::uint8_t>((1 << bin) | (1 << (next & 7)));
}

/// Weighted sums of the differences to the plane of a pixel, as far as something is farther.
struct EdgeSums
{
  float x = 0.0F, y = 0.0F;

  ROBOT_VISION_INLINE void add(float u, float v, float weight, float difference, float step)
  {
    const float value = lesser(greater(difference, -step), 0.0F) * weight;
    x += u * value;
    y += v * value;
  }
};

template <int... k>
ROBOT_VISION_INLINE void addRow(EdgeSums& sums, const float* row, float v, float weight, float expected, float slope,
                                float step, std::integer_sequence<int, k...> /*five*/)
{
  constexpr float kWeights[5] = {0.25F, 0.7F, 1.0F, 0.7F, 0.25F};  // across the direction of the derivative
  (sums.add(static_cast<float>(k - 2), v, kWeights[k] * weight,
            row[k - 2] - (expected + static_cast<float>(k - 2) * slope), step),
   ...);
}

void depthEdges(const float* const* rows, const RayGeometry& rays, const SlopeRow& slopes, float jump, int count,
                std::uint8_t* __restrict bins)
{
  const float* const from[5] = {rows[0], rows[1], rows[2], rows[3], rows[4]};
  const float *const across = slopes.across, *const along = slopes.along;
  const float to_right = 1.0F / rays.fx, to_below = 1.0F / rays.fy;
  for (int i = 0; i < count; ++i)
  {
    const float w = from[2][i], a = across[i] * to_right, b = along[i] * to_below;
    const float step = greater(jump * w, kMinStep);
    EdgeSums sums;
    addRow(sums, from[0] + i, -2.0F, 0.25F, w - 2.0F * b, a, step, Ring());
    addRow(sums, from[1] + i, -1.0F, 0.7F, w - b, a, step, Ring());
    addRow(sums, from[2] + i, 0.0F, 1.0F, w, a, step, Ring());
    addRow(sums, from[3] + i, 1.0F, 0.7F, w + b, a, step, Ring());
    addRow(sums, from[4] + i, 2.0F, 0.25F, w + 2.0F * b, a, step, Ring());
    const float beside = lesser(from[2][i - 1] + a, from[2][i + 1] - a);
    const float beyond = lesser(from[1][i] + b, from[3][i] - b);
    // The sums are at most 10 times the step. Scaled so that products of them and the tables fit integers.
    const float scale = 4096.0F / step;
    const auto sx = static_cast<std::int32_t>(sums.x * scale), sy = static_cast<std::int32_t>(sums.y * scale);
    const bool edge = (w > 0.0F) & (lesser(beside, beyond) - w <= -step) & ((sx != 0) | (sy != 0));
    bins[i] = edge ? edgeBins(octantOf(sx, sy, Octants())) : std::uint8_t{0};
  }
}

struct Gradient
{
  std::int32_t x = 0, y = 0, magnitude = -1;
};

/// The stronger one of a gradient and that of another channel.
ROBOT_VISION_INLINE Gradient stronger(const Gradient& other, const std::uint8_t* above, const std::uint8_t* row,
                                      const std::uint8_t* below)
{
  const std::int32_t x = (above[1] - above[-1]) + 2 * (row[1] - row[-1]) + (below[1] - below[-1]);
  const std::int32_t y = (below[-1] - above[-1]) + 2 * (below[0] - above[0]) + (below[1] - above[1]);
  const std::int32_t ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
  const std::int32_t magnitude = greater(ax, ay) + ((3 * lesser(ax, ay)) >> 3);  // the length, within 7 %
  const bool more = magnitude > other.magnitude;
  return {more ? x : other.x, more ? y : other.y, more ? magnitude : other.magnitude};
}

template <int kChannels>
void gradientsOf(const ChannelRows& rows, int count, std::int16_t* __restrict magnitudes,
                 std::uint8_t* __restrict octants)
{
  constexpr int kSecond = kChannels > 1 ? 1 : 0, kThird = kChannels > 2 ? 2 : 0;
  const std::uint8_t *const a0 = rows.above[0], *const r0 = rows.row[0], *const b0 = rows.below[0];
  const std::uint8_t *const a1 = rows.above[kSecond], *const r1 = rows.row[kSecond], *const b1 = rows.below[kSecond];
  const std::uint8_t *const a2 = rows.above[kThird], *const r2 = rows.row[kThird], *const b2 = rows.below[kThird];
  for (int i = 0; i < count; ++i)
  {
    Gradient gradient = stronger(Gradient(), a0 + i, r0 + i, b0 + i);
    if constexpr (kChannels > 1)
    {
      gradient = stronger(gradient, a1 + i, r1 + i, b1 + i);
      gradient = stronger(gradient, a2 + i, r2 + i, b2 + i);
    }
    magnitudes[i] = static_cast<std::int16_t>(gradient.magnitude);
    octants[i] = static_cast<std::uint8_t>(octantOf(gradient.x, gradient.y, Octants()));
  }
}

void gradients(const ChannelRows& rows, int count, const GradientRow& gradients)
{
  const auto find = rows.channels == 1 ? gradientsOf<1> : gradientsOf<3>;
  find(rows, count, gradients.magnitudes, gradients.octants);
}

void edges(const std::int16_t* above, const std::int16_t* row, const std::int16_t* below, const std::uint8_t* octants,
           int threshold, int count, std::uint8_t* __restrict bins)
{
  for (int i = 0; i < count; ++i)
  {
    const std::int32_t octant = octants[i], direction = ((octant + 2) >> 2) & 3;  // in eighths of a turn
    const std::int16_t across = greater(row[i - 1], row[i + 1]);
    const std::int16_t falling = greater(above[i - 1], below[i + 1]);
    const std::int16_t along = greater(above[i], below[i]);
    const std::int16_t rising = greater(above[i + 1], below[i - 1]);
    const std::int16_t beside = direction == 0 ? across : direction == 1 ? falling : direction == 2 ? along : rising;
    const bool edge = (row[i] >= threshold) & (row[i] >= beside);
    bins[i] = edge ? edgeBins(octant) : std::uint8_t{0};
  }
}

void join(const std::uint8_t* edges, const std::uint8_t* depth_edges, const std::uint8_t* surfaces, int count,
          std::uint32_t* __restrict joined)
{
  for (int i = 0; i < count; ++i)
    joined[i] = std::uint32_t{edges[i]} | std::uint32_t{depth_edges[i]} << 8 | std::uint32_t{surfaces[i]} << 16;
}

void unite(const std::uint32_t* row, const std::uint32_t* other, int shift, int count, std::uint32_t* __restrict united)
{
  for (int i = 0; i < count; ++i)
    united[i] = row[i] | row[i + shift] | other[i] | other[i + shift];
}

void ranges(const float* inverses, float steps, int count, std::uint32_t* __restrict ranges)
{
  constexpr float kMost = 65534.0F;
  for (int i = 0; i < count; ++i)
  {
    const auto number = static_cast<std::int32_t>(lesser(inverses[i] * steps + 0.5F, kMost));
    const auto code = static_cast<std::uint32_t>(greater(number, 1));
    ranges[i] = inverses[i] > 0.0F ? code << 16 | code : kNoRange;
  }
}

ROBOT_VISION_INLINE std::uint32_t wider(std::uint32_t a, std::uint32_t b)
{
  const std::uint32_t near_a = a & 0xFFFF, near_b = b & 0xFFFF, far_a = a >> 16, far_b = b >> 16;
  return (far_a < far_b ? far_a : far_b) << 16 | (near_a > near_b ? near_a : near_b);
}

void widen(const std::uint32_t* row, const std::uint32_t* other, int shift, int count, std::uint32_t* __restrict ranges)
{
  for (int i = 0; i < count; ++i)
    ranges[i] = wider(wider(row[i], row[i + shift]), wider(other[i], other[i + shift]));
}

}  // namespace

template <>
const FrameKernels KernelTable<FrameKernels, ROBOT_VISION_SET>::table = {
    inversesOfMillimetres,
    inversesOfMetres,
    {nearest<1>, nearest<2>, nearest<3>, nearest<4>},
    slopes,
    depthEdges,
    gradients,
    edges,
    join,
    ranges,
    unite,
    widen,
};

}  // namespace robot_vision
