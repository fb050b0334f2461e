#include "robot_vision/common/range.hpp"

#include <gtest/gtest.h>

#include <cstdint>

using namespace robot_vision;

TEST(ToText, writesSizesAsWidthTimesHeight)
{
  EXPECT_EQ(toText(cv::Size(640, 480)), "640x480");
  EXPECT_EQ(toText(cv::Size(-1, 0)), "-1x0");
  EXPECT_EQ(sizeText(1000000, 3), "1000000x3");  // no "1e+06", which toText(double) makes of it
  EXPECT_EQ(sizeText(UINT32_MAX, std::uint32_t{1}), "4294967295x1");
}
