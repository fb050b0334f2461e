#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "ros/images/growing_pause.hpp"

namespace robot_vision
{
namespace
{

using namespace std::chrono_literals;

const GrowingPause::Clock::time_point kBegin(1h);

/// The length of a pause that begins at a time.
std::chrono::seconds length(GrowingPause& pause, GrowingPause::Clock::time_point now, bool went_well)
{
  pause.begin(now, went_well);
  std::chrono::seconds length{};
  while (pause.isOn(now + length))
    ++length;
  return length;
}

struct Case
{
  bool went_well;
  std::chrono::milliseconds after;  // the last pause
  std::chrono::seconds expected;
};

TEST(GrowingPause, isOnlyOnAfterAFailure)
{
  GrowingPause pause(1s, 32s);
  EXPECT_FALSE(pause.isOn(kBegin));
  pause.begin(kBegin, true);
  EXPECT_TRUE(pause.isOn(kBegin + 999ms));
  EXPECT_FALSE(pause.isOn(kBegin + 1s));
}

TEST(GrowingPause, growsUnlessItWentWellForAsLongAsTheLastOne)
{
  const std::vector<Case> cases = {
      {false, 0s, 1s},     {false, 100s, 2s},  // nothing came
      {true, 30ms, 4s},                        // one of two publishers is well
      {true, 3999ms, 8s},  {true, 8s, 1s},    {true, 0s, 2s},   {false, 0s, 4s},
      {false, 0s, 8s},     {false, 0s, 16s},  {false, 0s, 32s}, {false, 0s, 32s},  // the limit
      {false, 1000s, 32s}, {true, 31s, 32s},  {true, 32s, 1s},
  };
  GrowingPause pause(1s, 32s);
  GrowingPause::Clock::time_point end = kBegin;
  for (const Case& one : cases)
  {
    const auto now = end + one.after;
    EXPECT_EQ(length(pause, now, one.went_well), one.expected) << one.after.count() << " ms";
    end = now + one.expected;
  }
}

}  // namespace
}  // namespace robot_vision
