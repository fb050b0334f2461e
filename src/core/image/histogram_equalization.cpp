#include "histogram_equalization.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "gray_histogram.hpp"
#include "gray_line_buffer.hpp"
#include "lut_kernels.hpp"
#include "robot_vision/image/encoding.hpp"
#include "row_bands.hpp"

namespace robot_vision
{
namespace
{

constexpr int kBlockPixels = 1 << 16;         // fit the cache, and are many enough for the cost of a call not to matter
constexpr int kMinPixelsPerThread = 1 << 17;  // fewer are not worth waking a thread

/// The lookup table of cv::equalizeHist, computed in float as there.
std::array<std::uint8_t, 256> equalizationTable(const GrayCounts& counts, int total)
{
  std::array<std::uint8_t, 256> table = {};
  const auto* darkest = std::find_if(counts.begin(), counts.end(), [](int count) { return count > 0; });
  const auto first = static_cast<std::size_t>(darkest - counts.begin());
  if (*darkest == total)
  {
    table[first] = static_cast<std::uint8_t>(first);
    return table;
  }
  const float scale = 255.0F / static_cast<float>(total - *darkest);
  int below = 0;
  for (std::size_t i = first + 1; i < table.size(); ++i)
  {
    below += counts[i];
    table[i] = cv::saturate_cast<std::uint8_t>(static_cast<float>(below) * scale);
  }
  return table;
}

/// Counts the gray levels of rows, a block at a time. Each block is first converted from `image` unless that is empty.
void countRows(const cv::Mat& image, const std::string& encoding, const cv::Range& rows, cv::Mat& plain,
               GrayHistogram& histogram)
{
  const int block_rows = rowsOf(kBlockPixels, plain.cols);
  for (int begin = rows.start; begin < rows.end; begin += block_rows)
  {
    const cv::Range block(begin, std::min(begin + block_rows, rows.end));
    if (!image.empty())
    {
      cv::Mat gray = plain.rowRange(block);
      toGray(image.rowRange(block), encoding, gray);
    }
    for (int y = block.start; y < block.end; ++y)
      histogram.add(plain.ptr(y), plain.cols);
  }
}

}  // namespace

void toEqualizedGray(const cv::Mat& image, const std::string& encoding, cv::Mat& plain, cv::Mat& equalized)
{
  cv::Mat unconverted;  // empty if all rows are converted before any is counted
  if (encoding != "mono8" && GrayLineBuffer::takes(encoding))
  {
    checkPixels(image, encoding);
    unconverted = image;
    plain.create(image.size(), CV_8UC1);
  }
  else
    toGray(image, encoding, plain);

  const int min_rows = rowsOf(kMinPixelsPerThread, plain.cols);
  const int threads = cv::getNumThreads();
  std::vector<GrayHistogram> histograms(static_cast<std::size_t>(bandsOf(plain.rows, threads, min_rows)));
  parallelForRows(plain.rows, threads, min_rows,
                  [&](int i, const cv::Range& rows)
                  { countRows(unconverted, encoding, rows, plain, histograms[static_cast<std::size_t>(i)]); });
  GrayCounts counts = {};
  for (const GrayHistogram& histogram : histograms)
    histogram.addTo(counts);

  const std::array<std::uint8_t, 256> table = equalizationTable(counts, plain.size().area());
  equalized.create(plain.size(), CV_8UC1);
  parallelForRows(plain.rows, threads, min_rows,
                  [&](int, const cv::Range& rows)
                  {
                    for (int y = rows.start; y < rows.end; ++y)
                      kernels<LutKernels>().apply_lut(table.data(), plain.ptr(y), plain.cols, equalized.ptr(y));
                  });
}

}  // namespace robot_vision
