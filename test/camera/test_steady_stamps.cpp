#include <gtest/gtest.h>

#include "ros/camera/steady_stamps.hpp"

using namespace robot_vision;

namespace
{

constexpr std::int64_t kPeriod = 40000000;  // ns

}  // namespace

TEST(SteadyStamps, areThoseOfTheClockWhileItRunsSteadily)
{
  SteadyStamps stamps;
  const ros::Time begin(1700000000, 5);
  for (int i = 0; i < 100; ++i)
  {
    const ros::Time time =
        begin + ros::Duration().fromNSec(i * kPeriod + i % 3 * 1000);  // with a jitter of the reading
    EXPECT_EQ(stamps.next(i * kPeriod, time), time);
  }
}

TEST(SteadyStamps, followAStepForward)
{
  SteadyStamps stamps;
  stamps.next(kPeriod, ros::Time(1000, 0));
  EXPECT_EQ(stamps.next(2 * kPeriod, ros::Time(5000, 0)), ros::Time(5000, 0));
}

TEST(SteadyStamps, neverGoBackWithTheClockAndCatchUpAgain)
{
  SteadyStamps stamps;
  ros::Time last;
  const auto clock = [](int i) { return ros::Time(1000, 0) + ros::Duration().fromNSec(i * kPeriod); };
  for (int i = 0; i < 10; ++i)
    last = stamps.next(i * kPeriod, clock(i));
  const ros::Duration step(2.0);
  int caught_up = 0;
  for (int i = 10; i < 200; ++i)
  {
    const ros::Time time = clock(i) - step;
    const ros::Time stamp = stamps.next(i * kPeriod, time);
    EXPECT_GE((stamp - last).toNSec(), kPeriod / 2);
    last = stamp;
    if (caught_up == 0 && stamp == time) caught_up = i;
    if (caught_up != 0) EXPECT_EQ(stamp, time);
  }
  EXPECT_NEAR(caught_up * 0.04, 10 * 0.04 + 2 * step.toSec(), 0.1);
}

TEST(SteadyStamps, neverGoBackFromOneDeviceToTheNext)
{
  SteadyStamps stamps;
  const ros::Time last = stamps.next(5 * kPeriod, ros::Time(1000, 200000000));
  const ros::Time first = stamps.next(4 * kPeriod, ros::Time(1000, 160000000));
  EXPECT_GT(first, last);
  EXPECT_LT((first - last).toSec(), 0.001);
}
