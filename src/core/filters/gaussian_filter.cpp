#include "gaussian_filter.hpp"

#include <algorithm>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/image/aligned_rows.hpp"
#include "core/image/row_bands.hpp"
#include "extended_rows.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMargin = 128;           // values that kernels may touch beyond the end of a row
constexpr int kMinRowsPerThread = 32;  // a thread reads half a window above and below its rows

/// The side of the window that cv::GaussianBlur takes for bytes and this sigma.
int sizeOf(double sigma)
{
  return cvRound(6.0 * sigma + 1.0) | 1;
}

void filterRows(const cv::Mat& image, const GaussWeights& weights, const cv::Range& rows, cv::Mat& out)
{
  const GaussKernels& kernel = kernels<GaussKernels>();
  const int half = weights.half();
  const int channels = image.channels();
  const int count = image.cols * channels;
  AlignedRows<std::uint16_t> sums;
  sums.resize(kRowsAtOnce, count + 2 * half * channels + kMargin);
  AlignedRows<std::uint8_t> means;  // beyond which the kernel writes, where `out` may belong to another thread
  means.resize(1, count + kMargin);
  std::vector<const std::uint8_t*> window(static_cast<std::size_t>(SymmetricWeights::rows(half)));
  std::uint16_t* inner[kRowsAtOnce];
  for (int i = 0; i < kRowsAtOnce; ++i)
    inner[i] = sums[i] + half * channels;
  for (int y = rows.start; y < rows.end; y += kRowsAtOnce)
  {
    for (std::size_t i = 0; i < window.size(); ++i)
      window[i] = extendedRow(image, y - half + static_cast<int>(i), cv::BORDER_DEFAULT);
    kernel.convolve_columns(window.data(), weights.weights(), count, inner);
    for (int i = 0; i < std::min(kRowsAtOnce, rows.end - y); ++i)
    {
      extendRow(inner[i], image.cols, channels, half, cv::BORDER_DEFAULT);
      kernel.convolve_row(sums[i], weights.weights(), channels, count, means[0]);
      std::copy_n(means[0], count, out.ptr(y + i));
    }
  }
}

}  // namespace

GaussianFilter::GaussianFilter(int size, double sigma)
  : size_(size), sigma_(sigma), weights_(size > 0 ? size : sizeOf(sigma), sigma), exact_(weights_.areExact())
{
}

void GaussianFilter::apply(const cv::Mat& image, cv::Mat& out) const
{
  if (image.depth() != CV_8U || !exact_)
  {
    cv::GaussianBlur(image, out, {size_, size_}, sigma_, 0.0, cv::BORDER_DEFAULT | cv::BORDER_ISOLATED);
    return;
  }
  if (weights_.half() == 0)
  {
    image.copyTo(out);
    return;
  }
  out.create(image.size(), image.type());
  parallelForRows(image.rows, cv::getNumThreads(), kMinRowsPerThread,
                  [&](int, const cv::Range& rows) { filterRows(image, weights_, rows, out); });
}

}  // namespace robot_vision
