#include "noise_rows.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "scene_random.hpp"

namespace robot_vision::scene
{

namespace
{

constexpr std::uint64_t kStartCount = 1 << 16;  // places in the list of numbers where a row may start

}  // namespace

std::uint64_t rowKey(std::uint64_t frame_key, int row)
{
  return mix(frame_key + static_cast<std::uint64_t>(row));
}

std::vector<float> NoiseRows::independentNumbers(std::uint64_t seed, int width, int block)
{
  NormalNumbers normal(seed);
  std::vector<float> numbers(kStartCount + static_cast<std::size_t>(width + block - 1));
  std::generate(numbers.begin(), numbers.end(), [&] { return static_cast<float>(normal.next()); });
  return numbers;
}

NoiseRows::NoiseRows(const std::vector<float>& numbers, int width, int block, std::uint64_t frame_key)
  : numbers_(numbers), width_(width), block_(block), frame_key_(frame_key)
{
  if (block_ == 1) return;
  columns_.resize(static_cast<std::size_t>(width_ + block_ - 1));
  sums_.resize(static_cast<std::size_t>(width_));
  for (int row = -(block_ / 2); row < block_ / 2; ++row)
    add(row, 1.0);
}

const float* NoiseRows::next()
{
  const int row = row_++;
  if (block_ == 1) return independent(row);
  add(row + block_ / 2, 1.0);
  const auto block = static_cast<std::size_t>(block_);
  double sum = std::accumulate(columns_.begin(), columns_.begin() + block_ - 1, 0.0);
  for (std::size_t x = 0; x < sums_.size(); ++x)
  {
    sum += columns_[x + block - 1];
    sums_[x] = static_cast<float>(sum / block_);
    sum -= columns_[x];
  }
  add(row - block_ / 2, -1.0);
  return sums_.data();
}

/// A row of independent numbers, also outside of the image.
const float* NoiseRows::independent(int row) const
{
  return numbers_.data() + rowKey(frame_key_, row) % kStartCount;
}

void NoiseRows::add(int row, double sign)
{
  const float* const numbers = independent(row);
  for (std::size_t x = 0; x < columns_.size(); ++x)
    columns_[x] += sign * numbers[x];
}

}  // namespace robot_vision::scene
