#include "box_filter_rows.hpp"

#include <cstring>

#include "box_kernels.hpp"

namespace robot_vision
{
namespace
{

constexpr int kWidest16 = 15;  // px, side of the largest box whose sum of bytes fits 16 bits

void slide(const std::uint8_t* entering, const std::uint8_t* leaving, int count, std::uint16_t* sums)
{
  kernels<BoxKernels>().slide16(entering, leaving, count, sums);
}

void slide(const std::uint8_t* entering, const std::uint8_t* leaving, int count, std::uint32_t* sums)
{
  kernels<BoxKernels>().slide32(entering, leaving, count, sums);
}

void widen(const std::uint16_t* single, const std::uint16_t* part, int width, bool odd, int count, std::uint16_t* wider)
{
  kernels<BoxKernels>().widen16(single, part, width, odd, count, wider);
}

void widen(const std::uint32_t* single, const std::uint32_t* part, int width, bool odd, int count, std::uint32_t* wider)
{
  kernels<BoxKernels>().widen32(single, part, width, odd, count, wider);
}

void divide(const std::uint16_t* sums, int by, int count, std::uint8_t* quotients)
{
  kernels<BoxKernels>().divide16(sums, Division(by), count, quotients);
}

// There is no tie, as the divisor is odd, and what is next to one is further from it than the quotient's rounding.
void divide(const std::uint32_t* sums, int by, int count, std::uint8_t* quotients)
{
  kernels<BoxKernels>().divide32(sums, 1.0F / static_cast<float>(by), count, quotients);
}

}  // namespace

Division::Division(int divisor) : half(static_cast<std::uint16_t>(divisor / 2)), factor(0), shift(0)
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
  if (size <= kWidest16)
    start(narrow_);
  else
    start(wide_);
}

void BoxFilterRows::next(std::uint8_t* means)
{
  if (size_ == 1)
    std::memcpy(means, rows_->row(y_), static_cast<std::size_t>(rows_->size().width));
  else if (size_ <= kWidest16)
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
  sums.nothing.resize(static_cast<std::size_t>(width));
  sums.columns.assign(static_cast<std::size_t>(width + 2 * half), 0);
  sums.boxes.resize(sums.columns.size());
  for (int y = y_ - half; y <= y_ + half; ++y)
    slide(rows_->mirroredRow(y), sums.nothing.data(), width, sums.columns.data() + half);
}

template <class Sum>
void BoxFilterRows::blur(Sums<Sum>& sums, std::uint8_t* means)
{
  const int width = rows_->size().width;
  const int half = size_ / 2;
  divide(addUp(sums), size_ * size_, width, means);
  slide(rows_->mirroredRow(y_ + 1 + half), rows_->mirroredRow(y_ - half), width, sums.columns.data() + half);
}

/// The sums of the boxes around the row's pixels.
template <class Sum>
const Sum* BoxFilterRows::addUp(Sums<Sum>& sums)
{
  const int width = rows_->size().width;
  const int half = size_ / 2;
  mirrorEnds(sums.columns.data() + half, width, half);
  // From sums of one column to those of as many as the box has, by the bits of that number from the highest one on.
  int bit = 0;
  while (size_ >> (bit + 1) > 0)
    ++bit;
  const Sum* part = sums.columns.data();
  for (int reach = 1; bit > 0;)
  {
    const int wider = size_ >> --bit;
    widen(sums.columns.data(), part, reach, wider % 2 != 0, width + size_ - wider, sums.boxes.data());
    part = sums.boxes.data();
    reach = wider;
  }
  return part;
}

}  // namespace robot_vision
