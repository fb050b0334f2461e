#include "pyramid_filter.hpp"

#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "core/image/aligned_rows.hpp"
#include "core/image/row_bands.hpp"
#include "extended_rows.hpp"
#include "pyramid_kernels.hpp"

namespace robot_vision
{
namespace
{

constexpr int kHalf = 2;  // px on each side of the window's middle

void halveRows(const cv::Mat& image, const cv::Range& rows, cv::Mat& out)
{
  const auto& kernel = kernels<PyramidKernels>();
  const int channels = image.channels();
  const int count = image.cols * channels;
  AlignedRows<std::uint16_t> sums;
  sums.resize(1, count + 2 * kHalf * channels);
  std::uint16_t* const inner = sums[0] + kHalf * channels;
  AlignedRows<std::uint8_t> blurred;
  blurred.resize(1, count);
  const std::uint8_t* window[2 * kHalf + 1];
  for (int y = rows.start; y < rows.end; ++y)
  {
    for (int i = 0; i <= 2 * kHalf; ++i)
      window[i] = extendedRow(image, 2 * y + i - kHalf, cv::BORDER_DEFAULT);
    kernel.sum_rows(window, count, inner);
    extendRow(inner, image.cols, channels, kHalf, cv::BORDER_DEFAULT);
    kernel.halve_row(inner, channels, image.cols, blurred[0], out.ptr(y));
  }
}

}  // namespace

void pyramidDown(const cv::Mat& image, cv::Mat& out)
{
  if (image.depth() != CV_8U)
  {
    cv::pyrDown(image, out);
    return;
  }
  out.create((image.rows + 1) / 2, (image.cols + 1) / 2, image.type());
  parallelForRows(out.rows, cv::getNumThreads(), kMinRows,
                  [&](int, const cv::Range& rows) { halveRows(image, rows, out); });
}

}  // namespace robot_vision
