#include "tile_equalization.hpp"

#include <algorithm>

#include "core/image/gray_histogram.hpp"
#include "core/image/lut_kernels.hpp"
#include "core/image/row_bands.hpp"
#include "tile_kernels.hpp"

namespace robot_vision
{
namespace
{

constexpr int kLevels = 256;

/// Cuts the counts off at `limit`, and spreads what is cut off over all levels.
void limitCounts(GrayCounts& counts, int limit)
{
  int clipped = 0;
  for (int& count : counts)
  {
    clipped += std::max(0, count - limit);
    count = std::min(count, limit);
  }
  const int each = clipped / kLevels;
  for (int& count : counts)
    count += each;
  int rest = clipped % kLevels;
  if (rest == 0) return;
  const int step = std::max(kLevels / rest, 1);
  for (int level = 0; level < kLevels && rest > 0; level += step, --rest)
    ++counts[static_cast<std::size_t>(level)];
}

}  // namespace

TileEqualizer::Places::Places(int pixels, int tile_size, int tiles)
{
  const float inverse = 1.0F / static_cast<float>(tile_size);
  for (int i = 0; i < pixels; ++i)
  {
    const float place = static_cast<float>(i) * inverse - 0.5F;
    const int tile = cvFloor(place);
    before.push_back(std::max(tile, 0));
    behind.push_back(std::min(tile + 1, tiles - 1));
    share_behind.push_back(place - static_cast<float>(tile));
    share_before.push_back(1.0F - share_behind.back());
  }
}

TileEqualizer::TileEqualizer(double limit, int tiles)
  : limit_(limit), tiles_(tiles), opencv_(cv::createCLAHE(limit, {tiles, tiles}))
{
}

void TileEqualizer::apply(const cv::Mat& gray, cv::Mat& out)
{
  static const bool exact = isExact();
  if (exact && gray.type() == CV_8UC1)
    equalize(gray, out);
  else
    opencv_->apply(gray.isSubmatrix() ? gray.clone() : gray, out);  // it would take pixels around a part of an image
}

void TileEqualizer::equalize(const cv::Mat& gray, cv::Mat& out)
{
  cv::Mat whole_tiles = gray;
  if (gray.cols % tiles_ != 0 || gray.rows % tiles_ != 0)
    cv::copyMakeBorder(gray, whole_tiles, 0, tiles_ - gray.rows % tiles_, 0, tiles_ - gray.cols % tiles_,
                       cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED);
  const cv::Size tile(whole_tiles.cols / tiles_, whole_tiles.rows / tiles_);
  std::vector<Table> tables(static_cast<std::size_t>(tiles_ * tiles_));
  cv::parallel_for_({0, tiles_ * tiles_},
                    [&](const cv::Range& some)
                    {
                      for (int i = some.start; i < some.end; ++i)
                        tables[static_cast<std::size_t>(i)] =
                            tableOf(whole_tiles({{i % tiles_ * tile.width, i / tiles_ * tile.height}, tile}));
                    });
  const Places x(gray.cols, tile.width, tiles_);
  const Places y(gray.rows, tile.height, tiles_);
  out.create(gray.size(), CV_8UC1);
  parallelForRows(gray.rows, cv::getNumThreads(), kMinRows,
                  [&](int, const cv::Range& rows) { interpolateRows(gray, tables, x, y, rows, out); });
}

TileEqualizer::Table TileEqualizer::tableOf(const cv::Mat& tile) const
{
  GrayHistogram histogram;
  for (int y = 0; y < tile.rows; ++y)
    histogram.add(tile.ptr(y), tile.cols);
  GrayCounts counts = {};
  histogram.addTo(counts);
  const int total = tile.size().area();
  limitCounts(counts, std::max(static_cast<int>(limit_ * total / kLevels), 1));
  const float scale = static_cast<float>(kLevels - 1) / static_cast<float>(total);
  Table table;
  int sum = 0;
  for (std::size_t level = 0; level < table.size(); ++level)
  {
    sum += counts[level];
    table[level] = cv::saturate_cast<std::uint8_t>(static_cast<float>(sum) * scale);
  }
  return table;
}

void TileEqualizer::interpolateRows(const cv::Mat& gray, const std::vector<Table>& tables, const Places& x,
                                    const Places& y, const cv::Range& rows, cv::Mat& out) const
{
  const auto width = static_cast<std::size_t>(gray.cols);
  std::vector<std::uint8_t> memory(4 * width);
  std::uint8_t* const looked_up[] = {&memory[0], &memory[width], &memory[2 * width], &memory[3 * width]};
  for (int row = rows.start; row < rows.end; ++row)
  {
    const auto i = static_cast<std::size_t>(row);
    for (std::size_t begin = 0, end = 0; begin < width; begin = end)  // pixels between the same tiles
    {
      while (end < width && x.before[end] == x.before[begin] && x.behind[end] == x.behind[begin])
        ++end;
      const int tiles[] = {y.before[i] * tiles_ + x.before[begin], y.before[i] * tiles_ + x.behind[begin],
                           y.behind[i] * tiles_ + x.before[begin], y.behind[i] * tiles_ + x.behind[begin]};
      for (int k = 0; k < 4; ++k)
        kernels<LutKernels>().apply_lut(tables[static_cast<std::size_t>(tiles[k])].data(), gray.ptr(row) + begin,
                                        static_cast<int>(end - begin), looked_up[k] + begin);
    }
    kernels<TileKernels>().interpolate({looked_up[0], looked_up[1], looked_up[2], looked_up[3]}, x.share_before.data(),
                                       x.share_behind.data(), y.share_before[i], y.share_behind[i], gray.cols,
                                       out.ptr(row));
  }
}

/// Compilers may let OpenCV round products and sums at once.
bool TileEqualizer::isExact()
{
  cv::Mat gray(120, 250, CV_8UC1);
  cv::RNG(1).fill(gray, cv::RNG::NORMAL, 120, 40);
  for (const double limit : {2.0, 40.0})
  {
    TileEqualizer equalizer(limit, 8);
    cv::Mat ours;
    cv::Mat theirs;
    equalizer.equalize(gray, ours);
    equalizer.opencv_->apply(gray, theirs);
    if (cv::norm(ours, theirs, cv::NORM_INF) != 0.0) return false;
  }
  return true;
}

}  // namespace robot_vision
