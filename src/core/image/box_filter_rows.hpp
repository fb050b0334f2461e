#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "box_kernels.hpp"

namespace robot_vision
{

constexpr int kMaxBoxSize = 31;  // px, side of the largest box for which BoxDivision is exact

/// Computes the rows of a box-filtered image of bytes from top to bottom, bit for bit as cv::blur does.
///
/// `Source` has the rows of the image, and continues them as a border of OpenCV's:
///
///   int width() const;                        // bytes of a row
///   int channels() const;
///   const std::uint8_t* row(int y) const;     // `y` may be outside of the image
///   template <class T>
///   void extend(T* row, int margin) const;    // writes `margin` pixels before a row of numbers and after it
template <class Source>
class BoxFilterRows
{
public:
  /// Begins at row `first` with a box of `size` px (odd, 1 to kMaxBoxSize). Until the last next(), `source` must have
  /// the rows of the box around the next row, and one more below it.
  void begin(const Source& source, int size, int first)
  {
    source_ = source;
    size_ = size;
    y_ = first;
    if (size == 1) return;
    if (size <= kMaxSize16)
      start(narrow_);
    else
      start(wide_);
  }

  /// Writes the next row, which has as many bytes as those of the source.
  void next(std::uint8_t* means)
  {
    if (size_ == 1)
      std::memcpy(means, source_.row(y_), static_cast<std::size_t>(source_.width()));
    else if (size_ <= kMaxSize16)
      blur(narrow_, means);
    else
      blur(wide_, means);
    ++y_;
  }

private:
  static constexpr int kMaxSize16 = 15;  // px, side of the largest box whose sum of bytes fits 16 bits

  template <class Sum>
  struct Sums
  {
    std::vector<Sum> columns;  // sums over the rows around the next one, with half a box more on both sides
    std::vector<Sum> boxes;    // sums over the boxes around the next row's pixels
  };

  int half() const { return size_ / 2; }

  /// The sum of the column of the first pixel, behind those of half a box.
  template <class Sum>
  Sum* inner(Sums<Sum>& sums) const
  {
    return sums.columns.data() + half() * source_.channels();
  }

  template <class Sum>
  void start(Sums<Sum>& sums)
  {
    const std::vector<std::uint8_t> nothing(static_cast<std::size_t>(source_.width()));
    sums.columns.assign(nothing.size() + static_cast<std::size_t>(2 * half() * source_.channels()), 0);
    sums.boxes.resize(sums.columns.size());
    for (int y = y_ - half(); y <= y_ + half(); ++y)
      kernels<BoxKernels<Sum>>().slide(source_.row(y), nothing.data(), source_.width(), inner(sums));
  }

  template <class Sum>
  void blur(Sums<Sum>& sums, std::uint8_t* means)
  {
    const auto& box = kernels<BoxKernels<Sum>>();
    source_.extend(inner(sums), half());
    box.divide(sumColumns(sums), BoxDivision(size_ * size_), source_.width(), means);
    box.slide(source_.row(y_ + 1 + half()), source_.row(y_ - half()), source_.width(), inner(sums));
  }

  /// Sums of w columns give sums of 2 w or 2 w + 1 columns, so that the binary digits of the box's width, from the
  /// highest one on, lead from one column to all of them.
  template <class Sum>
  const Sum* sumColumns(Sums<Sum>& sums) const
  {
    const int channels = source_.channels();
    int bit = 0;
    while (size_ >> (bit + 1) > 0)
      ++bit;
    const Sum* part = sums.columns.data();
    for (int columns = 1; bit > 0;)
    {
      const int wider = size_ >> --bit;
      const int length = source_.width() + (size_ - wider) * channels;
      kernels<BoxKernels<Sum>>().widen(sums.columns.data(), part, columns * channels, wider % 2 != 0, length,
                                       sums.boxes.data());
      part = sums.boxes.data();
      columns = wider;
    }
    return part;
  }

  Source source_;
  int size_ = 1;
  int y_ = 0;  // the next row
  Sums<std::uint16_t> narrow_;
  Sums<std::uint32_t> wide_;  // for boxes whose sums do not fit 16 bits
};

}  // namespace robot_vision
