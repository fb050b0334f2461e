#include "core/image/row_bands.hpp"

#include <gtest/gtest.h>

#include <mutex>
#include <vector>

using namespace robot_vision;

TEST(RowBands, haveAllRowsOnceHoweverManyThereAre)
{
  for (const int rows : {1, 100, 1 << 26, 70000000, 2147483647})
    for (const int threads : {1, 7, 32, 256})
    {
      std::mutex mutex;
      std::vector<cv::Range> bands(static_cast<std::size_t>(bandsOf(rows, threads, kMinRows)));
      parallelForRows(rows, threads, kMinRows,
                      [&](int i, const cv::Range& band)
                      {
                        const std::lock_guard<std::mutex> lock(mutex);
                        bands.at(static_cast<std::size_t>(i)) = band;
                      });
      int next = 0;
      for (const cv::Range& band : bands)
      {
        EXPECT_EQ(band.start, next) << rows << " " << threads;
        EXPECT_GT(band.end, next) << rows << " " << threads;
        next = band.end;
      }
      EXPECT_EQ(next, rows) << threads;
    }
}
