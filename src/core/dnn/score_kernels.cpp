#include "score_kernels.hpp"

#include "core/simd/kernel_numbers.hpp"

namespace robot_vision
{
namespace
{

ROBOT_VISION_INLINE std::int32_t rank(float score)
{
  return static_cast<std::int32_t>(bitsOf(score) + kRankOffset);
}

void keepBest(const float* scores, std::int32_t class_id, int count, std::int32_t* __restrict ranks,
              std::int32_t* __restrict classes)
{
  for (int i = 0; i < count; ++i)
  {
    const std::int32_t here = rank(scores[i]), best = ranks[i], known = classes[i];
    ranks[i] = here > best ? here : best;
    classes[i] = here > best ? class_id : known;
  }
}

std::int32_t bestRank(const float* scores, int count)
{
  std::int32_t best = kNoRank;
  for (int i = 0; i < count; ++i)
    best = greater(best, rank(scores[i]));
  return best;
}

}  // namespace

template <>
const ScoreKernels KernelTable<ScoreKernels, ROBOT_VISION_SET>::table = {
    keepBest,
    bestRank,
};

}  // namespace robot_vision
