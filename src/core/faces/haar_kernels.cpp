#include "haar_kernels.hpp"

#include <cmath>

#include "core/simd/kernel_numbers.hpp"

namespace robot_vision
{
namespace
{

#if defined(__AVX512BW__)
constexpr int kMaxBytes = 64;
#elif defined(__AVX2__)
constexpr int kMaxBytes = 32;
#else
constexpr int kMaxBytes = 16;
#endif

/// The compiler makes no vectors of loops that are as long as one, so these are its own.
template <int kBytes>
struct Vectors;

template <>
struct Vectors<16>
{
  using Integers [[gnu::vector_size(16)]] = std::int32_t;
  using Floats [[gnu::vector_size(16)]] = float;
};

template <>
struct Vectors<32>
{
  using Integers [[gnu::vector_size(32)]] = std::int32_t;
  using Floats [[gnu::vector_size(32)]] = float;
};

template <>
struct Vectors<64>
{
  using Integers [[gnu::vector_size(64)]] = std::int32_t;
  using Floats [[gnu::vector_size(64)]] = float;
};

/// As many windows as a vector of kBytes has lanes.
template <int kBytes>
struct Lanes
{
  using Integers = typename Vectors<kBytes>::Integers;
  using Floats = typename Vectors<kBytes>::Floats;

  static constexpr int kCount = kBytes / 4;
  static_assert(kCount <= kHaarMargin);

  template <class Vector, class Number>
  ROBOT_VISION_INLINE static Vector load(const Number* from)
  {
    Vector vector;
    std::memcpy(&vector, from, sizeof vector);
    return vector;
  }

  /// The sums of the pixels in a rectangle, weighted.
  ROBOT_VISION_INLINE static Floats sumOf(const std::int32_t* sums, const HaarCorners& corners, float weight)
  {
    const Integers sum = load<Integers>(sums + corners[0]) - load<Integers>(sums + corners[1]) -
                         load<Integers>(sums + corners[2]) + load<Integers>(sums + corners[3]);
    return __builtin_convertvector(sum, Floats) * weight;
  }

  /// A stump's votes.
  template <bool kPair>
  ROBOT_VISION_INLINE static Integers votesOf(const PlacedStump& stump, const std::int32_t* sums, const Floats& factor)
  {
    Floats feature = sumOf(sums, stump.corners[0], stump.weights[0]);
    feature += sumOf(sums, stump.corners[1], stump.weights[1]);
    if constexpr (!kPair) feature += sumOf(sums, stump.corners[2], stump.weights[2]);
    const Integers below = feature * factor < stump.threshold;
    return (below & (stump.below - stump.above)) + stump.above;
  }

  /// The votes of a stage for several runs of windows at a time, as they share the stumps' numbers.
  template <int kRuns>
  ROBOT_VISION_INLINE static void votesOf(const PlacedStage& stage, const std::int32_t* sums, const float* factors,
                                          const std::int32_t* first, Integers* sum)
  {
    const std::int32_t* at[kRuns];
    Floats factor[kRuns];
    Integers votes[kRuns] = {};
    for (int i = 0; i < kRuns; ++i)
    {
      at[i] = sums + first[i];
      factor[i] = load<Floats>(factors + first[i]);
    }
    const PlacedStump *stump = stage.stumps, *const pairs = stump + stage.pairs, *const end = stump + stage.count;
    for (; stump != pairs; ++stump)
      for (int i = 0; i < kRuns; ++i)
        votes[i] += votesOf<true>(*stump, at[i], factor[i]);
    for (; stump != end; ++stump)
      for (int i = 0; i < kRuns; ++i)
        votes[i] += votesOf<false>(*stump, at[i], factor[i]);
    for (int i = 0; i < kRuns; ++i)
      sum[i] = votes[i];
  }
};

int contrasts(const std::int32_t* sums, const std::int32_t* squares, const HaarCorners& corners, double area, int count,
              float* __restrict factors)
{
  int seen_count = 0;
  const std::int32_t *const a = sums + corners[0], *const b = sums + corners[1];
  const std::int32_t *const c = sums + corners[2], *const d = sums + corners[3];
  const std::int32_t *const p = squares + corners[0], *const q = squares + corners[1];
  const std::int32_t *const r = squares + corners[2], *const s = squares + corners[3];
  for (int i = 0; i < count; ++i)
  {
    const auto sum = static_cast<double>(a[i] - b[i] - c[i] + d[i]);
    // The integral image of the squares may overflow, the difference does not.
    const auto square = static_cast<double>(
        static_cast<std::int32_t>(static_cast<std::uint32_t>(p[i]) - static_cast<std::uint32_t>(q[i]) -
                                  static_cast<std::uint32_t>(r[i]) + static_cast<std::uint32_t>(s[i])));
    const double variance = area * square - sum * sum;
    const auto factor = static_cast<float>(1.0 / std::sqrt(variance > 1.0 ? variance : 1.0));
    const bool seen = (variance > 0.0) & (area * static_cast<double>(factor) < 0.1);
    factors[i] = seen ? factor : 0.0F;
    seen_count += seen ? 1 : 0;
  }
  return seen_count;
}

void judge(const PlacedStage& stage, const std::int32_t* sums, const float* factors, int count,
           std::uint8_t* __restrict verdicts)
{
  using All = Lanes<kMaxBytes>;
  for (std::int32_t first = 0; first < count; first += All::kCount)
  {
    All::Integers votes;
    All::votesOf<1>(stage, sums, factors, &first, &votes);
    const All::Integers unsure = (votes >= stage.rejected) & (votes < stage.passed) & kUnsure;
    const All::Integers verdict = ((votes >= stage.passed) & kPassed) | unsure;
    const All::Integers flat = All::load<All::Floats>(factors + first) == 0.0F;
    const All::Integers all = (flat & kFlat) | (~flat & verdict);
    for (int i = 0; i < All::kCount; ++i)
      verdicts[first + i] = static_cast<std::uint8_t>(all[i]);
  }
}

/// Windows are too far from each other to fill long vectors.
using Few = Lanes < kMaxBytes<32 ? kMaxBytes : 32>;
constexpr int kRuns = 4;

int keep(const PlacedStage& stage, const std::int32_t* sums, const float* factors, std::int32_t* windows, int count,
         std::uint8_t* verdicts)
{
  int kept = 0;
  for (int i = 0; i < count;)
  {
    std::int32_t first[kRuns];
    int ends[kRuns];
    int next = i;
    for (int k = 0; k < kRuns; ++k)
    {
      first[k] = windows[next < count ? next : i];
      while (next < count && windows[next] < first[k] + Few::kCount)
        ++next;
      ends[k] = next;
    }
    Few::Integers votes[kRuns];
    if (ends[0] == count)
      Few::votesOf<1>(stage, sums, factors, first, votes);
    else
      Few::votesOf<kRuns>(stage, sums, factors, first, votes);
    for (int k = 0; i < next; ++k)
    {
      std::int32_t vote[Few::kCount];
      std::memcpy(vote, &votes[k], sizeof vote);
      for (; i < ends[k]; ++i)
      {
        const std::int32_t window = windows[i], sum = vote[window - first[k]];
        windows[kept] = window;
        kept += sum >= stage.rejected ? 1 : 0;
        if (sum < stage.passed) verdicts[window] = kUnsure;
      }
    }
  }
  return kept;
}

}  // namespace

template <>
const HaarKernels KernelTable<HaarKernels, ROBOT_VISION_SET>::table = {contrasts, judge, keep};

}  // namespace robot_vision
