#include "lut_kernels.hpp"

#include <cstdint>
#include <cstring>

#ifdef __AVX512VBMI__
#include <immintrin.h>
#endif

namespace robot_vision
{
namespace
{

#ifdef __AVX512VBMI__

constexpr bool kFastLut = true;

/// Looks up 64 values at a time: the table fits four registers, and an instruction looks up in two of them.
void applyLut(const std::uint8_t* table, const std::uint8_t* values, int count, std::uint8_t* results)
{
  const __m512i part_0 = _mm512_loadu_si512(table);
  const __m512i part_1 = _mm512_loadu_si512(table + 64);
  const __m512i part_2 = _mm512_loadu_si512(table + 128);
  const __m512i part_3 = _mm512_loadu_si512(table + 192);
  for (int i = 0; i < count; i += 64)
  {
    const __mmask64 there = count - i >= 64 ? ~__mmask64{0} : (__mmask64{1} << (count - i)) - 1;
    const __m512i value = _mm512_maskz_loadu_epi8(there, values + i);
    const __m512i low = _mm512_permutex2var_epi8(part_0, value, part_1);
    const __m512i high = _mm512_permutex2var_epi8(part_2, value, part_3);
    const __m512i result = _mm512_mask_blend_epi8(_mm512_movepi8_mask(value), low, high);
    _mm512_mask_storeu_epi8(results + i, there, result);
  }
}

#else

constexpr bool kFastLut = false;

/// Loads 8 values at a time, which is faster than to load each by itself.
void applyLut(const std::uint8_t* table, const std::uint8_t* values, int count, std::uint8_t* results)
{
  constexpr int kBytes = 8;
  int i = 0;
  for (; i + kBytes <= count; i += kBytes)
  {
    std::uint64_t word;
    std::memcpy(&word, values + i, sizeof word);
    for (int byte = 0; byte < kBytes; ++byte)
    {
      results[i + byte] = table[word & 0xFF];
      word >>= 8;
    }
  }
  for (; i < count; ++i)
    results[i] = table[values[i]];
}

#endif

}  // namespace

template <>
const LutKernels KernelTable<LutKernels, ROBOT_VISION_SET>::table = {
    applyLut,
    kFastLut,
};

}  // namespace robot_vision
