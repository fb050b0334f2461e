#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "core/dnn/best_class.hpp"

using namespace robot_vision;

namespace
{

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Scores, many of them equal, with some that are none.
std::vector<float> scoresOf(int count, int seed)
{
  cv::RNG random(static_cast<std::uint64_t>(seed) + 1);
  const float odd[] = {kNan, -kNan, kInfinity, -kInfinity, -0.5F, -0.0F, 0.0F, 1e-42F, 3e38F};
  std::vector<float> scores;
  for (int i = 0; i < count; ++i)
    scores.push_back(random.uniform(0, 4) == 0 ? odd[random.uniform(0, 9)]
                                               : static_cast<float>(random.uniform(0, 50)) / 49.0F);
  return scores;
}

/// The first of the highest scores that are finite and not below 0; -1 of none.
int firstBest(const std::vector<float>& scores)
{
  int best = -1;
  for (std::size_t i = 0; i < scores.size(); ++i)
    if (std::isfinite(scores[i]) && !std::signbit(scores[i]) &&
        (best < 0 || scores[i] > scores[static_cast<std::size_t>(best)]))
      best = static_cast<int>(i);
  return best;
}

}  // namespace

TEST(Scores, ranksOrderThemAsTheyAre)
{
  const float rising[] = {0.0F, 1e-45F, 1e-38F, 0.1F, 0.5F, std::nextafter(0.5F, 1.0F), 1.0F, 3.4e38F};
  for (std::size_t i = 0; i < std::size(rising); ++i)
  {
    EXPECT_EQ(scoreOf(rankOf(rising[i])), rising[i]);
    if (i > 0)
    {
      EXPECT_GT(rankOf(rising[i]), rankOf(rising[i - 1]));
    }
  }
  for (const float none : {kNan, -kNan, kInfinity, -kInfinity, -1e-45F, -1.0F})
    EXPECT_LT(rankOf(none), rankOf(0.0F)) << none;
}

TEST(Scores, firstOfTheBestClassesOfARowIsFound)
{
  const ScoreKernels& kernel = kernels<ScoreKernels>();
  for (int count = 1; count < 100; ++count)
    for (int seed = 0; seed < 20; ++seed)
    {
      const std::vector<float> scores = scoresOf(count, 1000 * seed + count);
      const int expected = firstBest(scores);
      const BestClass found = bestClass(kernel, scores.data(), count, rankOf(0.0F));
      ASSERT_EQ(found.class_id, expected) << count << " " << seed;
      if (expected >= 0)
      {
        ASSERT_EQ(found.score, scores[static_cast<std::size_t>(expected)]);
      }
    }
  EXPECT_EQ(kernel.best_rank(nullptr, 0), kNoRank);
}

TEST(Scores, firstOfTheBestClassesOfEachColumnIsFound)
{
  const ScoreKernels& kernel = kernels<ScoreKernels>();
  constexpr int kClasses = 7;
  for (const int count : {1, 3, 8, 15, 16, 17, 64, 77})
  {
    std::vector<std::vector<float>> rows;
    for (int c = 0; c < kClasses; ++c)
      rows.push_back(scoresOf(count, 100 * count + c));
    std::vector<std::int32_t> ranks(static_cast<std::size_t>(count), kNoRank), classes(ranks.size(), -1);
    for (int c = 0; c < kClasses; ++c)
      kernel.keep_best(rows[static_cast<std::size_t>(c)].data(), c, count, ranks.data(), classes.data());
    for (std::size_t i = 0; i < ranks.size(); ++i)
    {
      std::vector<float> column;
      for (const std::vector<float>& row : rows)
        column.push_back(row[i]);
      const int expected = firstBest(column);
      if (expected < 0)
      {
        ASSERT_LT(ranks[i], rankOf(0.0F));
        continue;
      }
      ASSERT_EQ(classes[i], expected) << count << " " << i;
      ASSERT_EQ(scoreOf(ranks[i]), column[static_cast<std::size_t>(expected)]);
    }
  }
}
