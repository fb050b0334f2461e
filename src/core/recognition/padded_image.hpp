#pragma once

#include <algorithm>
#include <cstddef>
#include <opencv2/core.hpp>

#include "core/image/aligned_rows.hpp"

namespace robot_vision
{

/// An image with kPad px around it, which may be read and written, so that loops need not look where it
/// ends.
template <class T>
class PaddedImage
{
public:
  static constexpr int kPad = 32;  // px, on all sides

  /// Sets all to 0 unless the size is what it was before.
  void create(const cv::Size& size)
  {
    if (size == size_) return;
    size_ = size;
    rows_.resize(size.height + 2 * kPad, size.width + 2 * kPad);
    rows_.fill(T{});
  }

  T* operator[](int y) { return rows_[y + kPad] + kPad; }
  const T* operator[](int y) const { return const_cast<AlignedRows<T>&>(rows_)[y + kPad] + kPad; }

  /// How many numbers further the next row begins.
  int stride() const { return static_cast<int>(rows_.stride()); }

  const cv::Size& size() const { return size_; }
  void fill(T value) { rows_.fill(value); }

private:
  AlignedRows<T> rows_;
  cv::Size size_;
};

/// Several of them, of one size and one memory.
template <class T>
class PaddedImages
{
public:
  /// One of them; it goes with the others.
  struct View
  {
    T* first;  // pixel 0, 0
    int stride;

    T* operator[](int y) const { return first + static_cast<std::ptrdiff_t>(y) * stride; }
  };

  /// True: they are new, and all 0.
  bool create(const cv::Size& size, int count)
  {
    const int step = size.height + 2 * PaddedImage<T>::kPad;
    const cv::Size all(size.width, step * count - 2 * PaddedImage<T>::kPad);
    const bool is_new = all != images_.size() || step != step_;
    images_.create(all);
    if (is_new) images_.fill(T{});
    step_ = step;
    return is_new;
  }

  View operator[](std::size_t i) { return {images_[static_cast<int>(i) * step_], images_.stride()}; }

  struct ConstView
  {
    const T* first;
    int stride;

    const T* operator[](int y) const { return first + static_cast<std::ptrdiff_t>(y) * stride; }
  };
  ConstView operator[](std::size_t i) const { return {images_[static_cast<int>(i) * step_], images_.stride()}; }

  /// How many numbers after those of an image those of the next one begin.
  int next() const { return step_ * images_.stride(); }

  void fill(T value) { images_.fill(value); }

private:
  PaddedImage<T> images_;
  int step_ = 0;
};

}  // namespace robot_vision
