#include "gauss_kernels.hpp"

#include <cstdint>
#include <cstring>

#include "core/simd/vectors.hpp"

namespace robot_vision
{
namespace
{

constexpr int kBlock = 64;  // px whose sums stay in the level 1 cache

/// Computes one row of sums, in loops that compilers vectorize.
void convolveRowInLoops(const std::uint8_t* const* rows, const SymmetricWeights& weights, int count,
                        std::uint16_t* sums)
{
  const int half = weights.half;
  for (int begin = 0; begin < count; begin += kBlock)
  {
    const int block = count - begin < kBlock ? count - begin : kBlock;
    std::uint16_t totals[kBlock];
    for (int i = 0; i < block; ++i)
      totals[i] = static_cast<std::uint16_t>(kSumBias + rows[half][begin + i] * weights.words[half]);
    for (int j = 1; j <= half; ++j)
    {
      const std::uint8_t* const above = rows[half - j] + begin;
      const std::uint8_t* const below = rows[half + j] + begin;
      const int weight = weights.words[half + j];
      for (int i = 0; i < block; ++i)
        totals[i] = static_cast<std::uint16_t>(totals[i] + (above[i] + below[i]) * weight);
    }
    for (int i = 0; i < block; ++i)
      sums[begin + i] = totals[i];
  }
}

#ifdef ROBOT_VISION_VECTORS

using Vector = Simd::Vector;

constexpr int kVectorBytes = static_cast<int>(sizeof(Vector));

/// Words computed from bytes, in the order of InterleaveLower() and InterleaveUpper().
struct LowAndHigh
{
  Vector low;
  Vector high;
};

/// Loads bytes and subtracts 128 from each, because the products need signed bytes where the weights are unsigned. The
/// weighted sums become smaller by 128 * 256, which in 16 bits is the same as adding kSumBias.
inline Vector loadSigned(const std::uint8_t* from)
{
  return Simd::Xor(Simd::load(from), Simd::words(0x8080));
}

#ifdef __AVX512VNNI__

/// Computes sums of as many columns as a vector has bytes, four rows of the image at a time.
inline void convolveBlock(const std::uint8_t* const* rows, const SymmetricWeights& weights, int i, LowAndHigh* sums)
{
  Vector totals[kRowsAtOnce][4];
  for (auto& row : totals)
    for (Vector& total : row)
      total = Simd::zeros();
  const int end = SymmetricWeights::rows(weights.half);
  for (int j = 0; j < end; j += 4)
  {
    const Vector first = loadSigned(rows[j] + i);
    const Vector second = loadSigned(rows[j + 1] + i);
    const Vector third = loadSigned(rows[j + 2] + i);
    const Vector fourth = loadSigned(rows[j + 3] + i);
    const LowAndHigh upper = {Simd::InterleaveLower(first, second), Simd::InterleaveUpper(first, second)};
    const LowAndHigh lower = {Simd::InterleaveLower(third, fourth), Simd::InterleaveUpper(third, fourth)};
    const Vector columns[4] = {
        Simd::InterleaveLowerWords(upper.low, lower.low), Simd::InterleaveUpperWords(upper.low, lower.low),
        Simd::InterleaveLowerWords(upper.high, lower.high), Simd::InterleaveUpperWords(upper.high, lower.high)};
    for (int k = 0; k < kRowsAtOnce; ++k)
    {
      std::int32_t four;
      std::memcpy(&four, weights.bytes + j - k, sizeof four);
      for (int part = 0; part < 4; ++part)
        totals[k][part] = _mm512_dpbusd_epi32(totals[k][part], Simd::integers(four), columns[part]);
    }
  }
  for (int k = 0; k < kRowsAtOnce; ++k)
    sums[k] = {_mm512_packs_epi32(totals[k][0], totals[k][1]), _mm512_packs_epi32(totals[k][2], totals[k][3])};
}

#else

/// Computes sums of as many columns as a vector has bytes, two rows of the image at a time.
inline void convolveBlock(const std::uint8_t* const* rows, const SymmetricWeights& weights, int i, LowAndHigh* sums)
{
  for (int k = 0; k < kRowsAtOnce; ++k)
    sums[k] = {Simd::zeros(), Simd::zeros()};
  const int end = SymmetricWeights::rows(weights.half);
  for (int j = 0; j < end; j += 2)
  {
    const Vector upper = loadSigned(rows[j] + i);
    const Vector lower = loadSigned(rows[j + 1] + i);
    const Vector low = Simd::InterleaveLower(upper, lower);
    const Vector high = Simd::InterleaveUpper(upper, lower);
    for (int k = 0; k < kRowsAtOnce; ++k)
    {
      std::int16_t two;
      std::memcpy(&two, weights.bytes + j - k, sizeof two);
      sums[k].low = Simd::addBytePairs(sums[k].low, Simd::words(two), low);
      sums[k].high = Simd::addBytePairs(sums[k].high, Simd::words(two), high);
    }
  }
}

#endif

void convolveColumns(const std::uint8_t* const* rows, const SymmetricWeights& weights, int count,
                     std::uint16_t* const* sums)
{
  for (int i = 0; i < count; i += kVectorBytes)
  {
    if (count < kVectorBytes)
    {
      for (int k = 0; k < kRowsAtOnce; ++k)
        convolveRowInLoops(rows + k, weights, count, sums[k]);
      return;
    }
    const int begin = i + kVectorBytes <= count ? i : count - kVectorBytes;
    LowAndHigh block[kRowsAtOnce];
    convolveBlock(rows, weights, begin, block);
    for (int k = 0; k < kRowsAtOnce; ++k)
      Simd::storeInOrder(sums[k] + begin, block[k].low, block[k].high);
  }
}

/// Weighted sums for pixels with even indices and for those with odd indices.
struct EvenAndOdd
{
  Vector even = Simd::integers(kMeanOffset);
  Vector odd = Simd::integers(kMeanOffset);
};

/// The weights of a pair of neighbouring values in the windows of pixels with even indices, and in those of pixels with
/// odd indices, which begin one value later.
inline EvenAndOdd weightsOfPair(const std::uint16_t* weights)
{
  std::int32_t even, odd;
  std::memcpy(&even, weights, sizeof even);
  std::memcpy(&odd, weights - 1, sizeof odd);
  return {Simd::integers(even), Simd::integers(odd)};
}

inline void addPairs(Vector values, const EvenAndOdd& weights, EvenAndOdd& sums)
{
  sums.even = Simd::addWordPairs(sums.even, values, weights.even);
  sums.odd = Simd::addWordPairs(sums.odd, values, weights.odd);
}

/// Sums for as many pixels as a vector has bytes.
struct TwoSums
{
  EvenAndOdd first;
  EvenAndOdd second;
};

#ifdef __AVX512BW__

constexpr int kPairs = 16;  // pairs of words in a cache line

/// Adds the pairs from kFirst on, which begin in the first two of three cache lines. Vectors that begin within a line
/// are made in registers, because loading one would touch two cache lines.
template <int kFirst>
inline void addPairsOf(const Vector (&lines)[3], const std::uint16_t* weights, int count, TwoSums& sums)
{
  if constexpr (kFirst < kPairs)
  {
    if (kFirst >= count) return;
    const EvenAndOdd pair = weightsOfPair(weights + 2 * kFirst);
    addPairs(_mm512_alignr_epi32(lines[1], lines[0], kFirst), pair, sums.first);
    addPairs(_mm512_alignr_epi32(lines[2], lines[1], kFirst), pair, sums.second);
    addPairsOf<kFirst + 1>(lines, weights, count, sums);
  }
}

inline TwoSums addAllPairs(const std::uint16_t* values, const SymmetricWeights& weights)
{
  TwoSums sums;
  for (int first = 0; first <= weights.half; first += kPairs)
  {
    const std::uint16_t* const from = values + 2 * first;
    const Vector lines[3] = {Simd::load(from), Simd::load(from + 2 * kPairs), Simd::load(from + 4 * kPairs)};
    addPairsOf<0>(lines, weights.words + 2 * first, weights.half + 1 - first, sums);
  }
  return sums;
}

#else

inline TwoSums addAllPairs(const std::uint16_t* values, const SymmetricWeights& weights)
{
  TwoSums sums;
  for (int j = 0; j <= 2 * weights.half; j += 2)
  {
    const EvenAndOdd pair = weightsOfPair(weights.words + j);
    addPairs(Simd::load(values + j), pair, sums.first);
    addPairs(Simd::load(values + j + kVectorBytes / 2), pair, sums.second);
  }
  return sums;
}

#endif

/// The means of the pixels in their order, which are the upper words of the sums.
inline Vector means(const EvenAndOdd& sums)
{
  return Simd::Or(Simd::upperWords(sums.even), Simd::And(sums.odd, Simd::integers(static_cast<int>(0xFFFF0000U))));
}

/// The means of as many values as a vector has words, each over every channels-th value.
inline Vector meansOfChannels(const std::uint16_t* values, const SymmetricWeights& weights, int channels)
{
  Vector lower = Simd::integers(kMeanOffset);
  Vector upper = lower;
  for (int j = 0; j <= 2 * weights.half; j += 2)
  {
    std::int32_t two;
    std::memcpy(&two, weights.words + j, sizeof two);
    const Vector pair = Simd::integers(two);
    const Vector first = Simd::load(values + j * channels);
    const Vector second = Simd::load(values + (j + 1) * channels);
    lower = Simd::addWordPairs(lower, Simd::InterleaveLowerWords(first, second), pair);
    upper = Simd::addWordPairs(upper, Simd::InterleaveUpperWords(first, second), pair);
  }
  return Simd::packIntegers(Simd::upperWords(lower), Simd::upperWords(upper));
}

void convolveRow(const std::uint16_t* sums, const SymmetricWeights& weights, int channels, int count, std::uint8_t* row)
{
  if (channels == 1)
  {
    for (int i = 0; i < count; i += kVectorBytes)
    {
      const TwoSums around = addAllPairs(sums + i, weights);
      Simd::storeBytes(row + i, means(around.first), means(around.second));
    }
    return;
  }
  for (int i = 0; i < count; i += kVectorBytes)
    Simd::storeBytes(row + i, meansOfChannels(sums + i, weights, channels),
                     meansOfChannels(sums + i + kVectorBytes / 2, weights, channels));
}

#else

void convolveColumns(const std::uint8_t* const* rows, const SymmetricWeights& weights, int count,
                     std::uint16_t* const* sums)
{
  for (int k = 0; k < kRowsAtOnce; ++k)
    convolveRowInLoops(rows + k, weights, count, sums[k]);
}

void convolveRow(const std::uint16_t* sums, const SymmetricWeights& weights, int channels, int count,
                 std::uint8_t* __restrict means)
{
  for (int begin = 0; begin < count; begin += kBlock)
  {
    std::int32_t totals[kBlock];
    for (int i = 0; i < kBlock; ++i)
      totals[i] = kMeanOffset;
    for (int j = 0; j <= 2 * weights.half; ++j)
    {
      const std::uint16_t* const shifted = sums + begin + j * channels;
      const auto weight = static_cast<std::int16_t>(weights.words[j]);
      for (int i = 0; i < kBlock; ++i)
        totals[i] += static_cast<std::int16_t>(shifted[i]) * weight;
    }
    for (int i = 0; i < kBlock; ++i)
      means[begin + i] = static_cast<std::uint8_t>(totals[i] >> 16);
  }
}

#endif

}  // namespace

template <>
const GaussKernels KernelTable<GaussKernels, ROBOT_VISION_SET>::table = {
    convolveColumns,
    convolveRow,
};

}  // namespace robot_vision
