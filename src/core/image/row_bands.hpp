#pragma once

#include <algorithm>
#include <opencv2/core.hpp>

namespace robot_vision
{

constexpr int kMinRows = 16;  // that are worth a thread where a band costs nothing besides them

/// Rows of a width that have at least so many pixels.
inline int rowsOf(int pixels, int width)
{
  return std::max(1, pixels / std::max(1, width));
}

/// At most `threads` bands of at least `least` rows, or one: what a band costs besides its rows shall not count.
inline int bandsOf(int rows, int threads, int least)
{
  return std::max(1, std::min(threads, rows / least));
}

/// Runs `work` on (i, rows) for the bands 0 to bandsOf() - 1 of so many rows, each in a thread of OpenCV's pool.
template <class Work>
void parallelForRows(int rows, int threads, int least, const Work& work)
{
  const int count = bandsOf(rows, threads, least);
  if (count == 1)
  {
    work(0, cv::Range(0, rows));
    return;
  }
  const auto run = [&](const cv::Range& bands)
  {
    for (int i = bands.start; i < bands.end; ++i)
      work(i, cv::Range(rows * i / count, rows * (i + 1) / count));
  };
  cv::parallel_for_({0, count}, run, count);
}

}  // namespace robot_vision
