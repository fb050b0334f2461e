#include "box_filter.hpp"

#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "core/image/box_filter_rows.hpp"
#include "core/image/row_bands.hpp"
#include "extended_rows.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinRowsPerThread = 64;  // a thread adds up a whole box before its first row

/// The rows of an image of bytes, continued by one of OpenCV's borders, for BoxFilterRows.
struct BorderedRows
{
  const cv::Mat* image = nullptr;
  int border = cv::BORDER_DEFAULT;

  int width() const { return image->cols * image->channels(); }
  int channels() const { return image->channels(); }
  const std::uint8_t* row(int y) const { return extendedRow(*image, y, border); }

  template <class T>
  void extend(T* row, int margin) const
  {
    extendRow(row, image->cols, image->channels(), margin, border);
  }
};

}  // namespace

void boxFilter(const cv::Mat& image, int size, int border, cv::Mat& out)
{
  if (size == 1 || size > kMaxBoxSize || image.depth() != CV_8U)
  {
    cv::blur(image, out, {size, size}, {-1, -1}, border | cv::BORDER_ISOLATED);
    return;
  }
  out.create(image.size(), image.type());
  const auto filter = [&](int, const cv::Range& rows)
  {
    BoxFilterRows<BorderedRows> filtered;
    filtered.begin({&image, border}, size, rows.start);
    for (int y = rows.start; y < rows.end; ++y)
      filtered.next(out.ptr(y));
  };
  parallelForRows(image.rows, cv::getNumThreads(), kMinRowsPerThread, filter);
}

}  // namespace robot_vision
