#include "robot_vision/common/throttle.hpp"

#include <gtest/gtest.h>

#include <future>
#include <vector>

using namespace robot_vision;

TEST(Throttle, oneMessageOfManyThreadsGoesThrough)
{
  Throttle throttle;
  std::promise<void> start;
  const std::shared_future<void> started = start.get_future().share();
  std::vector<std::future<bool>> threads(8);
  for (std::future<bool>& thread : threads)
    thread = std::async(std::launch::async,
                        [&throttle, started]
                        {
                          started.wait();
                          return throttle.due();
                        });
  start.set_value();
  int through = 0;
  for (std::future<bool>& thread : threads)
    through += thread.get() ? 1 : 0;
  EXPECT_EQ(through, 1);
  EXPECT_FALSE(throttle.due());
  throttle.reset();
  EXPECT_TRUE(throttle.due());
}
