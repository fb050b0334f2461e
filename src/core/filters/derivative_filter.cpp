#include "derivative_filter.hpp"

#include <array>
#include <cstdint>
#include <vector>

#include "core/image/aligned_rows.hpp"
#include "core/image/row_bands.hpp"
#include "derivative_kernels.hpp"
#include "extended_rows.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxTaps = 5;

/// The weights of one side of a separable kernel, as many as kernels take.
using Weights = std::vector<std::int16_t>;

struct Separable
{
  explicit Separable(const Derivative& derivative)
  {
    cv::Mat along_x;
    cv::Mat along_y;
    cv::getDerivKernels(along_x, along_y, derivative.dx, derivative.dy, derivative.size, false, CV_32F);
    along_x.reshape(1, 1).convertTo(x, CV_16S);
    along_y.reshape(1, 1).convertTo(y, CV_16S);
  }

  Weights x;
  Weights y;
};

void filterRows(const cv::Mat& image, const Separable& kernel, const cv::Range& rows, cv::Mat& out)
{
  const auto& table = kernels<DerivativeKernels>();
  const int taps_x = static_cast<int>(kernel.x.size());
  const int taps_y = static_cast<int>(kernel.y.size());
  const int count = image.cols * image.channels();
  AlignedRows<std::int16_t> sums;
  sums.resize(1, count);
  std::array<const std::uint8_t*, kMaxTaps> window = {};
  for (int y = rows.start; y < rows.end; ++y)
  {
    for (int i = 0; i < taps_y; ++i)
      window[static_cast<std::size_t>(i)] = extendedRow(image, y + i - taps_y / 2, cv::BORDER_DEFAULT);
    table.sum_rows(window.data(), kernel.y.data(), taps_y, count, sums[0]);
    extendRow(sums[0], image.cols, image.channels(), taps_x / 2, cv::BORDER_DEFAULT);
    table.magnitudes(sums[0], kernel.x.data(), taps_x, image.channels(), count, out.ptr(y));
  }
}

}  // namespace

void derivativeMagnitude(const cv::Mat& image, const Derivative& derivative, cv::Mat& out)
{
  const bool has_kernels = derivative.size == 3 || derivative.size == 5 || derivative.size == cv::FILTER_SCHARR;
  if (!has_kernels || derivative.scale != 1.0 || image.depth() != CV_8U)
  {
    cv::Mat signed_derivative;
    cv::Sobel(image, signed_derivative, CV_16S, derivative.dx, derivative.dy, derivative.size, derivative.scale, 0.0,
              cv::BORDER_DEFAULT | cv::BORDER_ISOLATED);
    cv::convertScaleAbs(signed_derivative, out);
    return;
  }
  out.create(image.size(), image.type());
  const Separable kernel(derivative);
  parallelForRows(image.rows, cv::getNumThreads(), kMinRows,
                  [&](int, const cv::Range& rows) { filterRows(image, kernel, rows, out); });
}

}  // namespace robot_vision
