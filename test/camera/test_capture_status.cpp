#include <gtest/gtest.h>

#include "ros/camera/capture_status.hpp"

using namespace robot_vision;

namespace
{

using diagnostic_msgs::DiagnosticStatus;

class Status : public testing::Test
{
protected:
  std::string reported()
  {
    diagnostic_updater::DiagnosticStatusWrapper report;
    statistics_.report(report);
    const char* const levels[] = {"OK ", "WARN ", "ERROR "};
    return levels[report.level] + report.message;
  }

  FrameStatistics statistics_;
  CaptureStatus status_{statistics_};
};

}  // namespace

TEST_F(Status, isAnErrorFromTheLossOfTheSourceToTheNextFrame)
{
  EXPECT_TRUE(status_.opened("YUYV"));
  EXPECT_EQ(reported(), "OK YUYV");
  EXPECT_FALSE(status_.streaming());
  for (int i = 0; i < 3; ++i)
  {
    status_.lost("VIDIOC_STREAMON failed");
    EXPECT_EQ(reported(), "ERROR VIDIOC_STREAMON failed");
    EXPECT_FALSE(status_.opened("YUYV"));
    EXPECT_EQ(reported(), "ERROR VIDIOC_STREAMON failed");
  }
  EXPECT_TRUE(status_.streaming());
  EXPECT_EQ(reported(), "OK YUYV");
  EXPECT_FALSE(status_.streaming());
}

TEST_F(Status, tellsOfOtherStates)
{
  status_.lost("unplugged");
  status_.opened("YUYV");
  EXPECT_TRUE(status_.idle());
  EXPECT_EQ(reported(), "OK idle: nobody subscribes");
  EXPECT_FALSE(status_.idle());
  EXPECT_FALSE(status_.streaming());
  status_.stopped();
  EXPECT_EQ(reported(), "OK stopped: ~start_capture starts it again");
  status_.ended("");
  EXPECT_EQ(reported(), "OK the source has ended");
  status_.ended("truncated");
  EXPECT_EQ(reported(), "ERROR truncated");
}
