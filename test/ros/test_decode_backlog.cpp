#include <gtest/gtest.h>

#include "ros/transports/plugins/decode_backlog.hpp"

using robot_vision::DecodeBacklog;

TEST(DecodeBacklog, isTooLongWhenWhatWaitsWouldTakeHalfASecond)
{
  DecodeBacklog backlog;
  EXPECT_FALSE(backlog.isTooLong(1000));  // nothing is known yet
  for (int i = 0; i < 100; ++i)
    backlog.decoded(DecodeBacklog::Duration(0.04));
  EXPECT_FALSE(backlog.isTooLong(12));
  EXPECT_TRUE(backlog.isTooLong(13));
  backlog.decoded(DecodeBacklog::Duration(0.36));  // a single slow one counts as an eighth
  EXPECT_FALSE(backlog.isTooLong(6));
  EXPECT_TRUE(backlog.isTooLong(7));
}
