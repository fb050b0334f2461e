#include <gtest/gtest.h>

#include <chrono>
#include <future>

#include "ros/images/frame_statistics.hpp"

namespace robot_vision
{
namespace
{

using Status = diagnostic_updater::DiagnosticStatusWrapper;

TEST(FrameStatistics, framesAreCountedWhileAReportIsNotDone)
{
  FrameStatistics statistics;
  std::future<void> counted;
  bool is_counted = false;
  const auto count = [&]
  {
    counted = std::async(std::launch::async, [&] { statistics.received(1); });
    is_counted = counted.wait_for(std::chrono::seconds(10)) == std::future_status::ready;
    return std::uint64_t{0};
  };
  statistics.countUnshared(count);
  Status status;
  statistics.report(status);
  EXPECT_TRUE(is_counted);
}

TEST(FrameStatistics, reportsAreOfThePeriodAndTotalsOfAll)
{
  FrameStatistics statistics;
  statistics.setRunning("/image");
  const auto report = [&]
  {
    Status status;
    statistics.report(status);
    std::string text = status.message;
    for (const auto& value : status.values)
      if (value.key.find("frames") == 0 || value.key == "last error") text += "; " + value.key + ": " + value.value;
    return text;
  };
  statistics.received(1);
  statistics.received(4);
  statistics.refused("too small");
  const std::string totals =
      "; frames received: 2; frames published: 0; frames dropped: 2; frames refused: 1; last error: too small";
  EXPECT_EQ(report(), "1 frames refused" + totals);
  EXPECT_EQ(report(), "no frames on /image" + totals);
}

TEST(FrameStatistics, isSilentOnlyWhileAFrameIsWaitedFor)
{
  FrameStatistics statistics;
  statistics.setRunning("/image");
  const auto report = [&]
  {
    Status status;
    statistics.report(status);
    return status.message;
  };
  EXPECT_EQ(report(), "no frames on /image");
  statistics.received(1);
  statistics.setWaiting(false);
  for (int turn = 0; turn < 3; ++turn)
    EXPECT_EQ(report(), "running on /image");
  statistics.setWaiting(true);
  EXPECT_EQ(report(), "no frames on /image");
}

}  // namespace
}  // namespace robot_vision
