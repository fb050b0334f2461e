#include "key_bits.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>

namespace robot_vision
{
namespace
{

constexpr int kMaxRows = 2048;  // that are looked at
constexpr int kTrials = 32;     // bits of which the best is chosen
constexpr int kWord = 64;

double halfApart(double count, double rows)
{
  return std::abs(count / rows - 0.5);
}

}  // namespace

KeyBits::KeyBits(const cv::Mat& descriptors) : columns_(8 * static_cast<std::size_t>(descriptors.cols))
{
  const int step = (descriptors.rows + kMaxRows - 1) / kMaxRows, rows = (descriptors.rows + step - 1) / step;
  rows_ = rows;
  for (Column& column : columns_)
    column.assign(static_cast<std::size_t>((rows + kWord - 1) / kWord), 0);
  for (int row = 0; row < rows; ++row)
  {
    const std::uint8_t* const descriptor = descriptors.ptr(row * step);
    for (std::size_t bit = 0; bit < columns_.size(); ++bit)
      columns_[bit][static_cast<std::size_t>(row / kWord)] |= std::uint64_t{descriptor[bit / 8] >> (bit % 8) & 1U}
                                                              << row % kWord;
  }
}

double KeyBits::imbalance(int bit) const
{
  std::size_t ones = 0;
  for (const std::uint64_t word : columns_[static_cast<std::size_t>(bit)])
    ones += std::bitset<kWord>(word).count();
  return halfApart(static_cast<double>(ones), rows_);
}

double KeyBits::dependence(int bit, int other) const
{
  const Column &a = columns_[static_cast<std::size_t>(bit)], &b = columns_[static_cast<std::size_t>(other)];
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    different += std::bitset<kWord>(a[i] ^ b[i]).count();
  return halfApart(static_cast<double>(different), rows_);
}

std::vector<int> KeyBits::choose(int count, cv::RNG& random) const
{
  const auto all = static_cast<int>(columns_.size());
  std::vector<int> chosen;
  while (static_cast<int>(chosen.size()) < std::min(count, all))
  {
    int best = -1;
    double least = 0.0;
    for (int trial = 0; trial < kTrials || best < 0; ++trial)
    {
      const int bit = random.uniform(0, all);
      if (std::find(chosen.begin(), chosen.end(), bit) != chosen.end()) continue;
      double worst = imbalance(bit);
      for (const int other : chosen)
        worst = std::max(worst, dependence(bit, other));
      if (best >= 0 && !(worst < least)) continue;
      best = bit;
      least = worst;
    }
    chosen.push_back(best);
  }
  return chosen;
}

}  // namespace robot_vision
