// Tests of HSV ranges that do not depend on kernels.

#include <gtest/gtest.h>

#include <cstdlib>

#include "core/color/hsv_tests.hpp"
#include "support/hsv_ranges.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

// The vectorized kernels rely on this.
TEST(HsvTests, fitSignedBytes)
{
  static constexpr int kMax = 127;
  const auto check = [](const HsvRange& range)
  {
    const HsvTests tests(range);
    EXPECT_LE(tests.s_slack, kMax);
    EXPECT_LE(tests.h_slack, kMax);
    for (const SaturationLimit& limit : {tests.s_low, tests.s_above})
    {
      EXPECT_TRUE(0 <= limit.diff && limit.diff <= kMax) << limit.diff;
      EXPECT_TRUE(0 <= limit.value && limit.value <= kMax) << limit.value;
    }
    for (const HueLimit& limit : {tests.h_low, tests.h_above})
      for (int i = 0; i < 3; ++i)
      {
        EXPECT_LE(std::abs(limit.channels[i]), kMax);
        EXPECT_LE(std::abs(limit.channels[i] + limit.channels[(i + 1) % 3]), kMax);
      }
  };
  HsvRange range;
  for (range.s_low = 0; range.s_low <= 255; ++range.s_low)
    for (range.s_high = range.s_low; range.s_high <= 255; range.s_high += 16)
      check(range);
  range = HsvRange();
  for (range.h_low = 0; range.h_low <= 180; ++range.h_low)
    for (range.h_high = 0; range.h_high <= 180; range.h_high += 4)
      check(range);
}

TEST(HsvRange, surroundsAPickedColor)
{
  EXPECT_EQ(text(rangeAround({105, 200, 180})), text(hsvRange({95, 100, 100}, {115, 255, 255})));
  EXPECT_EQ(text(rangeAround({2, 0, 0}, 90)), text(hsvRange({0, 100, 100}, {179, 255, 255})));
  EXPECT_EQ(refusal([] { rangeAround({2, 0, 0}, 91); }), "margin is 91, must be from 0 to 90");
  EXPECT_EQ(text(rangeAround({4, 0, 0})), text(hsvRange({174, 100, 100}, {14, 255, 255})));
  EXPECT_EQ(text(rangeAround({185, 9, 9})), text(rangeAround({5, 9, 9})));
  for (int hue = 0; hue < 256; ++hue)
    EXPECT_NO_THROW(validate(rangeAround(cv::Vec3b(static_cast<std::uint8_t>(hue), 0, 0))));
}

TEST(HsvRange, outOfRangeIsNamed)
{
  EXPECT_EQ(refusal([] { validate(hsvRange({0, 10, 0}, {9, 9, 9})); }), "s_high is 9, must be from 10 to 255");
  EXPECT_EQ(refusal([] { HsvMask{hsvRange({0, 0, 7}, {9, 9, 6})}; }), "v_high is 6, must be from 7 to 255");
}
