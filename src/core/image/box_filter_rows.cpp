#include "box_filter_rows.hpp"

#include <cstring>

#include "box_kernels.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxSize16 = 15;  // px, side of the largest box whose sum of bytes fits 16 bits

}  // namespace

Division::Division(int divisor)
  : half(static_cast<std::uint16_t>(divisor / 2)), factor(0), shift(0), reciprocal(1.0F / static_cast<float>(divisor))
{
  while (2 << shift <= divisor)
    ++shift;
  const std::uint32_t one = 1U << (16 + shift);
  factor = static_cast<std::uint16_t>((one + static_cast<std::uint32_t>(divisor) - 1) / divisor);
}

void BoxFilterRows::begin(GrayLineBuffer& rows, int size, int first)
{
  rows_ = &rows;
  size_ = size;
  y_ = first;
  if (size == 1) return;
  if (size <= kMaxSize16)
    start(narrow_);
  else
    start(wide_);
}

void BoxFilterRows::next(std::uint8_t* means)
{
  if (size_ == 1)
    std::memcpy(means, rows_->row(y_), static_cast<std::size_t>(rows_->size().width));
  else if (size_ <= kMaxSize16)
    blur(narrow_, means);
  else
    blur(wide_, means);
  ++y_;
}

template <class Sum>
void BoxFilterRows::start(Sums<Sum>& sums)
{
  const int width = rows_->size().width;
  const int half = size_ / 2;
  sums.black_row.resize(static_cast<std::size_t>(width));
  sums.columns.assign(static_cast<std::size_t>(width + 2 * half), 0);
  sums.boxes.resize(sums.columns.size());
  for (int y = y_ - half; y <= y_ + half; ++y)
    kernels<BoxKernels<Sum>>().slide(rows_->mirroredRow(y), sums.black_row.data(), width, sums.columns.data() + half);
}

template <class Sum>
void BoxFilterRows::blur(Sums<Sum>& sums, std::uint8_t* means)
{
  const int width = rows_->size().width;
  const int half = size_ / 2;
  const auto& box = kernels<BoxKernels<Sum>>();
  box.divide(sumBoxes(sums), Division(size_ * size_), width, means);
  box.slide(rows_->mirroredRow(y_ + 1 + half), rows_->mirroredRow(y_ - half), width, sums.columns.data() + half);
}

template <class Sum>
const Sum* BoxFilterRows::sumBoxes(Sums<Sum>& sums)
{
  const int width = rows_->size().width;
  const int half = size_ / 2;
  mirrorEnds(sums.columns.data() + half, width, half);
  // Sums of w columns give sums of 2 w or 2 w + 1 columns, so that the binary digits of the box's width, from the
  // highest one on, lead from one column to all of them.
  int bit = 0;
  while (size_ >> (bit + 1) > 0)
    ++bit;
  const Sum* part = sums.columns.data();
  for (int columns = 1; bit > 0;)
  {
    const int wider = size_ >> --bit;
    kernels<BoxKernels<Sum>>().widen(sums.columns.data(), part, columns, wider % 2 != 0, width + size_ - wider,
                                     sums.boxes.data());
    part = sums.boxes.data();
    columns = wider;
  }
  return part;
}

}  // namespace robot_vision
