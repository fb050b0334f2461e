#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// Chooses bits of descriptors (CV_8UC1, a row for each) that tell them apart: by chance, but those that are as often 0
/// as 1, and differ from each other as often as not. For one thread at a time.
class KeyBits
{
public:
  explicit KeyBits(const cv::Mat& descriptors);

  /// `count` different bits, as indices, or all if there are not as many. The same for the same random numbers.
  std::vector<int> choose(int count, cv::RNG& random) const;

private:
  using Column = std::vector<std::uint64_t>;  // a bit of all rows

  /// How much one bit tells of another, 0 to 0.5; without the other, how far it is from being as often 0 as 1.
  double dependence(int bit, int other) const;
  double imbalance(int bit) const;

  std::vector<Column> columns_;
  double rows_ = 0.0;
};

}  // namespace robot_vision
