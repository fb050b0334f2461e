#pragma once

#include <cstdint>

#include "score_kernels.hpp"

namespace robot_vision
{

struct BestClass
{
  int class_id = -1;  // -1 if no score reaches the lowest threshold
  float score = 0.0F;
};

/// The first of the classes with the highest finite score, if that has at least the rank `lowest`.
inline BestClass bestClass(const ScoreKernels& kernel, const float* scores, int classes, std::int32_t lowest)
{
  const std::int32_t best = kernel.best_rank(scores, classes);
  if (best < lowest) return {};
  int first = 0;
  while (rankOf(scores[first]) != best)
    ++first;
  return {first, scores[first]};
}

}  // namespace robot_vision
