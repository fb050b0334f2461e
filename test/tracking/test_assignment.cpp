#include "robot_vision/tracking/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// The largest sum of gains of any assignment of the rows from `row` on to the columns that are free.
double bestSum(const cv::Mat_<double>& gains, int row, std::vector<char>& taken)
{
  if (row == gains.rows) return 0.0;
  double best = bestSum(gains, row + 1, taken);
  for (int column = 0; column < gains.cols; ++column)
  {
    if (taken[static_cast<std::size_t>(column)] || gains(row, column) <= 0.0) continue;
    taken[static_cast<std::size_t>(column)] = true;
    best = std::max(best, gains(row, column) + bestSum(gains, row + 1, taken));
    taken[static_cast<std::size_t>(column)] = false;
  }
  return best;
}

/// The sum of the gains of an assignment; none if it is not one.
std::optional<double> sumOf(const cv::Mat_<double>& gains, const std::vector<int>& columns)
{
  std::vector<char> taken(static_cast<std::size_t>(gains.cols), false);
  if (columns.size() != static_cast<std::size_t>(gains.rows)) return std::nullopt;
  double sum = 0.0;
  for (int row = 0; row < gains.rows; ++row)
  {
    const int column = columns[static_cast<std::size_t>(row)];
    if (column < 0) continue;
    if (column >= gains.cols || taken[static_cast<std::size_t>(column)] || !(gains(row, column) > 0.0))
      return std::nullopt;
    taken[static_cast<std::size_t>(column)] = true;
    sum += gains(row, column);
  }
  return sum;
}

}  // namespace

TEST(BestAssignment, HasTheLargestSumOfAll)
{
  cv::RNG random(7);
  for (int trial = 0; trial < 2000; ++trial)
  {
    cv::Mat_<double> gains(random.uniform(0, 7), random.uniform(0, 7));
    const double share = random.uniform(0.1, 1.0);  // of gains above 0
    const bool in_steps = trial % 2 == 0;           // many sums are the same
    for (double& gain : gains)
    {
      gain = random.uniform(0.0, 1.0) < share ? random.uniform(0.0, 1.0) : random.uniform(-1.0, 0.0);
      if (in_steps) gain = std::round(4.0 * gain) / 4.0;
    }
    const std::optional<double> sum = sumOf(gains, bestAssignment(gains));
    std::vector<char> taken(static_cast<std::size_t>(gains.cols), false);
    ASSERT_TRUE(sum) << gains;
    ASSERT_NEAR(*sum, bestSum(gains, 0, taken), 1e-12) << gains;
  }
}

TEST(BestAssignment, RefusesGainsThatAreNone)
{
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e13})
  {
    cv::Mat_<double> gains(2, 3, 0.5);
    gains(1, 2) = bad;
    EXPECT_NE(refusal([&] { bestAssignment(gains); }).find("gains[1][2] is "), std::string::npos);
  }
}

TEST(BestAssignment, ReadsAPartOfALargerMatrix)
{
  cv::Mat_<double> around(4, 5, 9.0);
  cv::Mat_<double> gains = around(cv::Rect(1, 1, 2, 2));
  gains(0, 0) = gains(1, 1) = 0.1;
  gains(0, 1) = gains(1, 0) = 0.2;
  EXPECT_EQ(bestAssignment(gains), (std::vector<int>{1, 0}));
}
