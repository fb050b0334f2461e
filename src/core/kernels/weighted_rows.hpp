#pragma once

#include <cstdint>

#include "kernels.hpp"
#include "vectors.hpp"

namespace robot_vision
{
namespace  // one for each instruction set
{

constexpr int kBlock = 64;  // px whose sums stay in the cache next to the processor

/// Up to kBlock columns.
void weighBlockInLoops(const std::uint8_t* const* rows, const SymmetricWeights& weights, int begin, int count,
                       std::uint16_t* sums)
{
  const int half = weights.half;
  std::uint16_t totals[kBlock];
  for (int i = 0; i < count; ++i)
    totals[i] = static_cast<std::uint16_t>(kSumBias + rows[half][begin + i] * weights.values[0]);
  for (int j = 1; j <= half; ++j)
  {
    const std::uint8_t* const above = rows[half - j] + begin;
    const std::uint8_t* const below = rows[half + j] + begin;
    const std::uint16_t weight = weights.values[j];
    for (int i = 0; i < count; ++i)
    {
      const auto both = static_cast<std::uint16_t>(above[i] + below[i]);
      const auto weighed = static_cast<std::uint16_t>(std::uint32_t{both} * weight);
      totals[i] = static_cast<std::uint16_t>(totals[i] + weighed);
    }
  }
  for (int i = 0; i < count; ++i)
    sums[begin + i] = totals[i];
}

#ifdef ROBOT_VISION_VECTORS

using Vector = Simd::Vector;

constexpr int kVectorBytes = static_cast<int>(sizeof(Vector));

void weighBlock(const std::uint8_t* const* rows, const SymmetricWeights& weights, int i, std::uint16_t* sums)
{
  const int half = weights.half;
  const Vector bias = Simd::words(kSumBias);
  const Vector center = Simd::load(rows[half] + i);
  const Vector center_weight = Simd::words(weights.values[0]);
  Vector low = Simd::addWords(bias, Simd::multiplyWords(Simd::lowBytes(center, Simd::zeros()), center_weight));
  Vector high = Simd::addWords(bias, Simd::multiplyWords(Simd::highBytes(center, Simd::zeros()), center_weight));
  for (int j = 1; j <= half; ++j)
  {
    const Vector above = Simd::load(rows[half - j] + i);
    const Vector below = Simd::load(rows[half + j] + i);
    const Vector weight = Simd::words(weights.values[j] * 0x0101);
    low = Simd::addBytePairs(low, Simd::lowBytes(above, below), weight);
    high = Simd::addBytePairs(high, Simd::highBytes(above, below), weight);
  }
  Simd::storeInOrder(sums + i, low, high);
}

void weighColumns(const std::uint8_t* const* rows, const SymmetricWeights& weights, int count, std::uint16_t* sums)
{
  int i = 0;
  for (; i + kVectorBytes <= count; i += kVectorBytes)
    weighBlock(rows, weights, i, sums);
  if (i == count) return;
  if (count >= kVectorBytes)
    weighBlock(rows, weights, count - kVectorBytes, sums);
  else
    weighBlockInLoops(rows, weights, 0, count, sums);
}

/// Weighed sums around pixels with even and with odd indices.
struct EvenAndOdd
{
  Vector even;
  Vector odd;
};

#ifdef __AVX512BW__

constexpr int kPairs = 16;  // in a line of the cache

/// Adds the pairs from kFirst on, which begin in the first of two lines: a vector from the middle of them is made in
/// registers, as each load of one touches both.
template <int kFirst>
inline void addPairs(const EvenAndOdd& line, const EvenAndOdd& next, const std::int32_t* pairs, int count,
                     EvenAndOdd& sums)
{
  if constexpr (kFirst < kPairs)
  {
    if (kFirst >= count) return;
    const Vector pair = Simd::integers(pairs[kFirst]);
    sums.even = Simd::addWordPairs(sums.even, _mm512_alignr_epi32(next.even, line.even, kFirst), pair);
    sums.odd = Simd::addWordPairs(sums.odd, _mm512_alignr_epi32(next.odd, line.odd, kFirst), pair);
    addPairs<kFirst + 1>(line, next, pairs, count, sums);
  }
}

inline void addPairs(const std::uint16_t* values, const SymmetricWeights& weights, EvenAndOdd& sums)
{
  EvenAndOdd line = {Simd::load(values), Simd::load(values + 1)};
  for (int first = 0; first <= weights.half; first += kPairs)
  {
    const std::uint16_t* const after = values + 2 * (first + kPairs);
    const EvenAndOdd next = {Simd::load(after), Simd::load(after + 1)};
    addPairs<0>(line, next, weights.pairs + first, weights.half + 1 - first, sums);
    line = next;
  }
}

#else

inline void addPairs(const std::uint16_t* values, const SymmetricWeights& weights, EvenAndOdd& sums)
{
  for (int j = 0; j <= weights.half; ++j)
  {
    const Vector pair = Simd::integers(weights.pairs[j]);
    sums.even = Simd::addWordPairs(sums.even, Simd::load(values + 2 * j), pair);
    sums.odd = Simd::addWordPairs(sums.odd, Simd::load(values + 2 * j + 1), pair);
  }
}

#endif

/// The means around as many pixels as a Vector has words.
inline Vector weighNeighbours(const std::uint16_t* sums, const SymmetricWeights& weights)
{
  EvenAndOdd means = {Simd::integers(kMeanOffset), Simd::integers(kMeanOffset)};
  addPairs(sums, weights, means);
  return Simd::eitherBits(Simd::upperWords(means.even),
                          Simd::commonBits(means.odd, Simd::integers(static_cast<int>(0xFFFF0000U))));
}

void weighRow(const std::uint16_t* sums, const SymmetricWeights& weights, int count, std::uint8_t* means)
{
  for (int i = 0; i < count; i += kVectorBytes)
  {
    const Vector first = weighNeighbours(sums + i, weights);
    const Vector second = weighNeighbours(sums + i + kVectorBytes / 2, weights);
    Simd::storeBytes(means + i, first, second);
  }
}

#else

void weighColumns(const std::uint8_t* const* rows, const SymmetricWeights& weights, int count, std::uint16_t* sums)
{
  for (int begin = 0; begin < count; begin += kBlock)
    weighBlockInLoops(rows, weights, begin, count - begin < kBlock ? count - begin : kBlock, sums);
}

void weighRow(const std::uint16_t* sums, const SymmetricWeights& weights, int count, std::uint8_t* __restrict means)
{
  for (int begin = 0; begin < count; begin += kBlock)
  {
    std::int32_t totals[kBlock];
    for (int i = 0; i < kBlock; ++i)
      totals[i] = kMeanOffset;
    for (int j = -weights.half; j <= weights.half; ++j)
    {
      const std::uint16_t* const of_tap = sums + begin + weights.half + j;
      const auto weight = static_cast<std::int16_t>(weights.values[j < 0 ? -j : j]);
      for (int i = 0; i < kBlock; ++i)
        totals[i] += static_cast<std::int16_t>(of_tap[i]) * weight;
    }
    for (int i = 0; i < kBlock; ++i)
      means[begin + i] = static_cast<std::uint8_t>(totals[i] >> 16);
  }
}

#endif

}  // namespace
}  // namespace robot_vision
