#include "box_filter.hpp"

#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/image/box_kernels.hpp"
#include "core/image/row_bands.hpp"
#include "extended_rows.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxSize16 = 15;         // px, side of the largest box whose sum of bytes fits 16 bits
constexpr int kMaxSize = 31;           // px, for which Division is exact
constexpr int kMinRowsPerThread = 64;  // a thread adds up a whole box before its first row

/// Rows of one part of an image after the filter, from top to bottom.
template <class Sum>
class BoxRows
{
public:
  BoxRows(const cv::Mat& image, int size, int border, int first)
    : image_(image),
      size_(size),
      half_(size / 2),
      border_(border),
      y_(first),
      columns_(static_cast<std::size_t>((image.cols + 2 * half_) * image.channels())),
      boxes_(columns_.size())
  {
    const std::vector<std::uint8_t> zeros(columns_.size());
    for (int y = first - half_; y <= first + half_; ++y)
      kernel().slide(extendedRow(image_, y, border_), zeros.data(), count(), inner());
  }

  void next(std::uint8_t* means)
  {
    extendRow(inner(), image_.cols, image_.channels(), half_, border_);
    kernel().divide(sumColumns(), Division(size_ * size_), count(), means);
    const std::uint8_t* entering = extendedRow(image_, y_ + 1 + half_, border_);
    kernel().slide(entering, extendedRow(image_, y_ - half_, border_), count(), inner());
    ++y_;
  }

private:
  static const BoxKernels<Sum>& kernel() { return kernels<BoxKernels<Sum>>(); }
  int count() const { return image_.cols * image_.channels(); }
  Sum* inner() { return columns_.data() + half_ * image_.channels(); }

  /// Sums of w columns give sums of 2 w or 2 w + 1 columns, so that the binary digits of the box's width, from the
  /// highest one on, lead from one column to all of them.
  const Sum* sumColumns()
  {
    const int channels = image_.channels();
    int bit = 0;
    while (size_ >> (bit + 1) > 0)
      ++bit;
    const Sum* part = columns_.data();
    for (int width = 1; bit > 0;)
    {
      const int wider = size_ >> --bit;
      const int length = (image_.cols + size_ - wider) * channels;
      kernel().widen(columns_.data(), part, width * channels, wider % 2 != 0, length, boxes_.data());
      part = boxes_.data();
      width = wider;
    }
    return part;
  }

  const cv::Mat& image_;
  int size_;
  int half_;
  int border_;
  int y_;                     // the next row
  std::vector<Sum> columns_;  // sums over the rows around the next one, with half a box more on both sides
  std::vector<Sum> boxes_;    // sums over boxes around the next row's pixels
};

template <class Sum>
void filterRows(const cv::Mat& image, int size, int border, const cv::Range& rows, cv::Mat& out)
{
  BoxRows<Sum> filter(image, size, border, rows.start);
  for (int y = rows.start; y < rows.end; ++y)
    filter.next(out.ptr(y));
}

}  // namespace

void boxFilter(const cv::Mat& image, int size, int border, cv::Mat& out)
{
  if (size == 1 || size > kMaxSize || image.depth() != CV_8U)
  {
    cv::blur(image, out, {size, size}, {-1, -1}, border | cv::BORDER_ISOLATED);
    return;
  }
  out.create(image.size(), image.type());
  const auto filter = size <= kMaxSize16 ? filterRows<std::uint16_t> : filterRows<std::uint32_t>;
  parallelForRows(image.rows, cv::getNumThreads(), kMinRowsPerThread,
                  [&](int, const cv::Range& rows) { filter(image, size, border, rows, out); });
}

}  // namespace robot_vision
