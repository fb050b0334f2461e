#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace robot_vision
{

/// Rows of numbers, each of which begins at a line of the processor's cache: a vector register as long as a cache line
/// would touch two of them if it were loaded from anywhere else. Each row has a margin of kMargin numbers (one cache
/// line) on both sides, which may be read and written.
template <class T>
class AlignedRows
{
public:
  static constexpr std::size_t kMargin = 64 / sizeof(T);

  AlignedRows() = default;
  AlignedRows(AlignedRows&&) = default;  // no copies: the rows of a copy would not be aligned
  AlignedRows& operator=(AlignedRows&&) = default;

  /// Leaves all numbers undefined, and keeps the memory if that is large enough.
  void resize(int rows, int width)
  {
    const std::size_t lines = (static_cast<std::size_t>(width) + kMargin - 1) / kMargin + 2;
    // The number of cache lines is odd, because rows at powers of two from each other would evict each other.
    stride_ = (lines | 1) * kMargin;
    size_ = stride_ * static_cast<std::size_t>(rows);
    if (memory_.size() < size_ + kMargin) memory_.resize(size_ + kMargin);
  }

  void fill(T value) { std::fill_n(begin(), size_, value); }

  T* operator[](int row) { return begin() + stride_ * static_cast<std::size_t>(row) + kMargin; }

  /// How many numbers further the next row begins.
  std::size_t stride() const { return stride_; }

private:
  T* begin()
  {
    const auto misaligned = reinterpret_cast<std::uintptr_t>(memory_.data()) / sizeof(T) % kMargin;
    return memory_.data() + (kMargin - misaligned) % kMargin;
  }

  std::vector<T> memory_;
  std::size_t stride_ = 0;
  std::size_t size_ = 0;
};

}  // namespace robot_vision
