#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace robot_vision
{

/// Rows of numbers that each begin with a line of the processor's cache: vectors as long as one touch two lines
/// anywhere else. Before and after each row there are a line's numbers that belong to it, too.
template <class T>
class AlignedRows
{
public:
  static constexpr std::size_t kMargin = 64 / sizeof(T);

  AlignedRows() = default;
  AlignedRows(AlignedRows&&) = default;  // a copy's rows would not begin where the others do
  AlignedRows& operator=(AlignedRows&&) = default;

  /// All numbers are undefined then. Memory is kept.
  void resize(int rows, int width)
  {
    const std::size_t lines = (static_cast<std::size_t>(width) + kMargin - 1) / kMargin + 2;
    stride_ = (lines | 1) * kMargin;  // odd: rows at powers of two from each other would share few places of the cache
    size_ = stride_ * static_cast<std::size_t>(rows);
    if (memory_.size() < size_ + kMargin) memory_.resize(size_ + kMargin);
  }

  void fill(T value) { std::fill_n(begin(), size_, value); }

  T* operator[](int row) { return begin() + stride_ * static_cast<std::size_t>(row) + kMargin; }

  /// Numbers from a row to the next one.
  std::size_t stride() const { return stride_; }

private:
  T* begin()
  {
    const auto beyond = reinterpret_cast<std::uintptr_t>(memory_.data()) / sizeof(T) % kMargin;
    return memory_.data() + (kMargin - beyond) % kMargin;
  }

  std::vector<T> memory_;
  std::size_t stride_ = 0;
  std::size_t size_ = 0;
};

}  // namespace robot_vision
