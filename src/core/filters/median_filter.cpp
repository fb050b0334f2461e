#include "median_filter.hpp"

#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/image/aligned_rows.hpp"
#include "core/image/row_bands.hpp"
#include "extended_rows.hpp"
#include "median_kernels.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinSize = 7;  // px: OpenCV has networks of its own for smaller windows

void filterRows(const cv::Mat& image, int size, const cv::Range& rows, cv::Mat& out)
{
  const auto& kernel = kernels<MedianKernels>();
  const int half = size / 2;
  const int count = image.cols * image.channels();
  AlignedRows<std::uint8_t> memory;
  memory.resize(size, count);
  std::vector<std::uint8_t*> sorted;
  for (int y = 0; y < size; ++y)
    sorted.push_back(memory[y]);
  std::vector<const std::uint8_t*> window(sorted.size());
  for (int y = rows.start; y < rows.end; ++y)
  {
    for (int i = 0; i < size; ++i)
      window[static_cast<std::size_t>(i)] = extendedRow(image, y + i - half, cv::BORDER_REPLICATE);
    kernel.sort_columns(window.data(), size, count, sorted.data());
    for (std::uint8_t* row : sorted)
      extendRow(row, image.cols, image.channels(), half, cv::BORDER_REPLICATE);
    kernel.medians(sorted.data(), size, image.channels(), count, out.ptr(y));
  }
}

}  // namespace

void medianFilter(const cv::Mat& image, int size, cv::Mat& out)
{
  const auto& kernel = kernels<MedianKernels>();
  const bool is_sorted = size >= kMinSize && size <= kernel.max_size && image.depth() == CV_8U;
  if (!is_sorted || image.cols * image.channels() < kernel.min_count)
  {
    cv::medianBlur(image, out, size);
    return;
  }
  out.create(image.size(), image.type());
  parallelForRows(image.rows, cv::getNumThreads(), kMinRows,
                  [&](int, const cv::Range& rows) { filterRows(image, size, rows, out); });
}

}  // namespace robot_vision
