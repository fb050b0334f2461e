#pragma once

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>

namespace robot_vision
{

constexpr int kMinRows = 16;  // rows that are worth a thread if a band costs nothing besides its rows

/// The number of rows of this width that have about so many pixels, at least 1.
inline int rowsOf(int pixels, int width)
{
  return std::max(1, pixels / std::max(1, width));
}

/// The number of bands that `rows` are divided into: at most `threads`, each of at least `min_rows` so that the cost of
/// a band besides its rows does not matter.
inline int bandsOf(int rows, int threads, int min_rows)
{
  return std::max(1, std::min(threads, rows / min_rows));
}

/// Divides `rows` into bandsOf() bands, and calls work(i, rows of band i) for each of them in a thread of OpenCV's
/// pool.
template <class Work>
void parallelForRows(int rows, int threads, int min_rows, const Work& work)
{
  const int count = bandsOf(rows, threads, min_rows);
  if (count == 1)
  {
    work(0, cv::Range(0, rows));
    return;
  }
  // An image may have so many rows that their product with the number of bands is no int.
  const auto begin = [&](int i) { return static_cast<int>(std::int64_t{rows} * i / count); };
  const auto run = [&](const cv::Range& bands)
  {
    for (int i = bands.start; i < bands.end; ++i)
      work(i, cv::Range(begin(i), begin(i + 1)));
  };
  cv::parallel_for_({0, count}, run, count);
}

}  // namespace robot_vision
