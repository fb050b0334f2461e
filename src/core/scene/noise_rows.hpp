#pragma once

#include <cstdint>
#include <vector>

namespace robot_vision::scene
{

/// Normally distributed numbers with a standard deviation of 1 for the pixels of a frame, made row by row. With a block
/// of 1 px they are independent. With a larger one, of b px, each is the sum of as many independent ones as a block of
/// b x b px around it has, divided by b: the correlation of two that are dx and dy px apart is (1 - |dx| / b) (1 - |dy|
/// / b), and 0 from b px on. That is what a matcher's errors are like which compares such blocks.
class NoiseRows
{
public:
  /// The independent numbers that rows of this width are taken from.
  static std::vector<float> independentNumbers(std::uint64_t seed, int width, int block);

  /// Begins with the row 0 of a frame. `block` is odd, and `numbers` are for it and for this width; they must outlive
  /// the rows.
  NoiseRows(const std::vector<float>& numbers, int width, int block, std::uint64_t frame_key);

  /// The numbers of the next row, valid until the next call.
  const float* next();

private:
  const float* independent(int row) const;
  void add(int row, double sign);

  const std::vector<float>& numbers_;
  int width_, block_;
  std::uint64_t frame_key_;
  int row_ = 0;
  std::vector<double> columns_;  // sums of the independent rows around row_
  std::vector<float> sums_;      // of the last row
};

/// The key that all that is random in a row of a frame depends on.
std::uint64_t rowKey(std::uint64_t frame_key, int row);

}  // namespace robot_vision::scene
