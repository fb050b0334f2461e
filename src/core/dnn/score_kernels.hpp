#pragma once

#include <cstdint>
#include <cstring>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{

/// Added to the bits of a float, it makes a signed integer of them that grows with the float from 0 up, and is less for
/// NaN, infinities and what is below 0 than for 0: the sum of all that is not finite and has no sign overflows.
constexpr std::uint32_t kRankOffset = 0x00800000;

/// The rank of a score; ranks order finite scores from 0 up as the scores themselves.
inline std::int32_t rankOf(float score)
{
  std::uint32_t bits;
  std::memcpy(&bits, &score, sizeof bits);
  return static_cast<std::int32_t>(bits + kRankOffset);
}

/// The score of a rank.
inline float scoreOf(std::int32_t rank)
{
  const std::uint32_t bits = static_cast<std::uint32_t>(rank) - kRankOffset;
  float score;
  std::memcpy(&score, &bits, sizeof score);
  return score;
}

/// The lowest rank of all, which no score from 0 up has.
constexpr std::int32_t kNoRank = INT32_MIN;

struct ScoreKernels
{
  /// Notes the class, and its rank, where it is above the best rank so far.
  void (*keep_best)(const float* scores, std::int32_t class_id, int count, std::int32_t* ranks, std::int32_t* classes);
  /// The highest rank of `count` scores; kNoRank of none.
  std::int32_t (*best_rank)(const float* scores, int count);
};

}  // namespace robot_vision
