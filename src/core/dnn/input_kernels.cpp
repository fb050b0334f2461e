#include "input_kernels.hpp"

#include "core/simd/kernel_numbers.hpp"
#include "core/simd/pixel_vectors.hpp"

namespace robot_vision
{
namespace
{

#ifdef ROBOT_VISION_PIXELS

template <int size>
ROBOT_VISION_INLINE void storePlanes(const Planes& planes, std::uint8_t (&to)[3][size])
{
  Simd::store(to[0], planes.first);
  Simd::store(to[1], planes.second);
  Simd::store(to[2], planes.third);
}

#endif

/// Blends `count` numbers of two rows, which are `step` apart in each.
template <int step>
ROBOT_VISION_INLINE void blend(const std::uint8_t* a, const std::uint8_t* b, float share, int count,
                               float* __restrict values)
{
  for (int i = 0; i < count; ++i)
  {
    const auto above = static_cast<float>(a[step * i]), below = static_cast<float>(b[step * i]);
    values[i] = above + (below - above) * share;
  }
}

void blendRows(const std::uint8_t* a, const std::uint8_t* b, float share, int count, float* first, float* second,
               float* third)
{
  float* const to[] = {first, second, third};
  int done = 0;
#ifdef ROBOT_VISION_PIXELS
  constexpr int kPixels = sizeof(Simd::Vector);
  for (; done + kPixels <= count; done += kPixels)
  {
    const Planes above = loadPlanes(a + 3 * done), below = loadPlanes(b + 3 * done);
    std::uint8_t pixels_a[3][kPixels], pixels_b[3][kPixels];
    storePlanes(above, pixels_a);
    storePlanes(below, pixels_b);
    for (int c = 0; c < 3; ++c)
      blend<1>(pixels_a[c], pixels_b[c], share, kPixels, to[c] + done);
  }
#endif
  for (int c = 0; c < 3; ++c)
    blend<3>(a + 3 * done + c, b + 3 * done + c, share, count - done, to[c] + done);
}

#ifndef __AVX512F__

/// Columns from `begin` to `end`.
void blendPlainly(const float* row, const InputColumns& columns, int begin, int end, float factor, float offset,
                  float* __restrict values)
{
  const std::int32_t* const first = columns.first;
  const float* const share = columns.share;
  for (int i = begin; i < end; ++i)
  {
    const float* const at = row + first[i];
    const float value = at[0] + (at[1] - at[0]) * share[i];
    values[i] = value * factor + offset;
  }
}

#endif

// The columns of a group are close to each other in the row, so that they can be permuted from two vectors of it, which
// is faster than to load each, or to gather them.

#if defined(__AVX512F__)

void blendColumns(const float* row, const InputColumns& columns, int count, float factor, float offset, float* values)
{
  constexpr int kLanes = 16;
  const __m512 factors = _mm512_set1_ps(factor), offsets = _mm512_set1_ps(offset);
  const __m512i one = _mm512_set1_epi32(1);
  for (int i = 0; i < count;)
  {
    const std::int32_t base = columns.first[i];
    int group = count - i < kLanes ? count - i : kLanes;
    while (columns.first[i + group - 1] - base >= 2 * kLanes - 1)
      group /= 2;
    const auto lanes = static_cast<__mmask16>((1U << group) - 1);
    const __m512i place = _mm512_sub_epi32(_mm512_maskz_loadu_epi32(lanes, columns.first + i), _mm512_set1_epi32(base));
    const __m512 low = _mm512_loadu_ps(row + base), high = _mm512_loadu_ps(row + base + kLanes);
    const __m512 a = _mm512_permutex2var_ps(low, place, high);
    const __m512 b = _mm512_permutex2var_ps(low, _mm512_add_epi32(place, one), high);
    const __m512 share = _mm512_maskz_loadu_ps(lanes, columns.share + i);
    const __m512 value = _mm512_add_ps(a, _mm512_mul_ps(_mm512_sub_ps(b, a), share));
    _mm512_mask_storeu_ps(values + i, lanes, _mm512_add_ps(_mm512_mul_ps(value, factors), offsets));
    i += group;
  }
}

#elif defined(__AVX2__)

/// Numbers of two vectors, as if they were one.
ROBOT_VISION_INLINE __m256 permuted(__m256 low, __m256 high, __m256i place)
{
  const __m256 of_low = _mm256_permutevar8x32_ps(low, place), of_high = _mm256_permutevar8x32_ps(high, place);
  return _mm256_blendv_ps(of_low, of_high, _mm256_castsi256_ps(_mm256_slli_epi32(place, 28)));  // where it is above 7
}

void blendColumns(const float* row, const InputColumns& columns, int count, float factor, float offset, float* values)
{
  constexpr int kLanes = 8;
  const __m256 factors = _mm256_set1_ps(factor), offsets = _mm256_set1_ps(offset);
  const __m256i one = _mm256_set1_epi32(1);
  int i = 0;
  for (; i + kLanes <= count; i += kLanes)
  {
    const std::int32_t base = columns.first[i];
    if (columns.first[i + kLanes - 1] - base >= 2 * kLanes - 1)
    {
      blendPlainly(row, columns, i, i + kLanes, factor, offset, values);
      continue;
    }
    const __m256i first = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(columns.first + i));
    const __m256i place = _mm256_sub_epi32(first, _mm256_set1_epi32(base));
    const __m256 low = _mm256_loadu_ps(row + base), high = _mm256_loadu_ps(row + base + kLanes);
    const __m256 a = permuted(low, high, place), b = permuted(low, high, _mm256_add_epi32(place, one));
    const __m256 value = _mm256_add_ps(a, _mm256_mul_ps(_mm256_sub_ps(b, a), _mm256_loadu_ps(columns.share + i)));
    _mm256_storeu_ps(values + i, _mm256_add_ps(_mm256_mul_ps(value, factors), offsets));
  }
  blendPlainly(row, columns, i, count, factor, offset, values);
}

#else

void blendColumns(const float* row, const InputColumns& columns, int count, float factor, float offset, float* values)
{
  blendPlainly(row, columns, 0, count, factor, offset, values);
}

#endif

void interleave(const float* first, const float* second, const float* third, int count, float* __restrict values)
{
  for (int i = 0; i < count; ++i)
  {
    values[3 * i] = first[i];
    values[3 * i + 1] = second[i];
    values[3 * i + 2] = third[i];
  }
}

}  // namespace

template <>
const InputKernels KernelTable<InputKernels, ROBOT_VISION_SET>::table = {
    blendRows,
    blendColumns,
    interleave,
};

}  // namespace robot_vision
