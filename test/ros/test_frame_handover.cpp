#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>
#include <vector>

#include "ros/images/frame_handover.hpp"

namespace robot_vision
{
namespace
{

using Way = FrameHandover::Way;

std_msgs::Header header(std::uint32_t seq)
{
  std_msgs::Header made;
  made.seq = seq;
  made.stamp.sec = 10 + seq;
  return made;
}

/// Whether the frame is delivered.
bool deliver(FrameHandover& handover, Way way, std::uint32_t seq)
{
  const bool is_delivered = handover.begin(way, header(seq));
  if (is_delivered) handover.finish();
  return is_delivered;
}

TEST(FrameHandover, beginsWithRawAndLeavesTheOtherWayOut)
{
  FrameHandover handover;
  EXPECT_TRUE(deliver(handover, Way::kRaw, 1));
  EXPECT_FALSE(handover.accepts(Way::kShared));
  EXPECT_FALSE(deliver(handover, Way::kShared, 2));
  EXPECT_TRUE(deliver(handover, Way::kRaw, 2));
}

TEST(FrameHandover, leavesOutWhatComesInTheThreadThatDelivers)
{
  FrameHandover handover;
  ASSERT_TRUE(handover.begin(Way::kRaw, header(1)));
  EXPECT_FALSE(deliver(handover, Way::kRaw, 2));  // of a callback that spins
  handover.finish();
  EXPECT_TRUE(deliver(handover, Way::kRaw, 3));
}

TEST(FrameHandover, deliversEachFrameOnceWhileBothWaysBringIt)
{
  for (const std::uint32_t ahead : {0U, 1U, 20U})  // frames by which the old way is ahead
  {
    FrameHandover handover;
    std::vector<std::uint32_t> delivered;
    const auto bring = [&](Way way, std::uint32_t seq)
    {
      if (deliver(handover, way, seq)) delivered.push_back(seq);
    };
    for (std::uint32_t seq = 1; seq <= 5 + ahead; ++seq)
      bring(Way::kRaw, seq);
    handover.allow(Way::kShared);
    for (std::uint32_t seq = 5; seq <= 40; ++seq)
    {
      bring(Way::kShared, seq);
      bring(Way::kRaw, seq + ahead);
    }
    std::vector<std::uint32_t> expected(40);
    for (std::uint32_t i = 0; i < 40; ++i)
      expected[i] = i + 1;
    EXPECT_EQ(delivered, expected) << ahead;
  }
}

TEST(FrameHandover, knowsAFrameThoughEachWayHasNumbersOfItsOwn)
{
  for (const std::uint32_t others : {7U, 500U})  // what the shared frames' numbers are ahead by
  {
    FrameHandover handover;
    std::vector<std::uint32_t> numbers;
    const auto bring = [&](Way way, std::uint32_t frame)
    {
      std_msgs::Header brought = header(frame);
      if (way == Way::kShared) brought.seq += others;
      if (!handover.begin(way, brought)) return;
      numbers.push_back(handover.sequence(brought));
      handover.finish();
    };
    bring(Way::kRaw, 1);
    bring(Way::kRaw, 2);
    handover.allow(Way::kShared);
    bring(Way::kShared, 2);
    bring(Way::kShared, 3);
    bring(Way::kRaw, 3);
    handover.allow(Way::kRaw);
    bring(Way::kRaw, 4);
    handover.allow(Way::kShared);
    bring(Way::kShared, 5);  // one that did not come over raw
    bring(Way::kShared, 6);
    EXPECT_EQ(numbers, (std::vector<std::uint32_t>{1, 2, 3, 4, 5, 6}));
  }
}

TEST(FrameHandover, sendersOfTheSameStampAreToldApart)
{
  FrameHandover handover;
  EXPECT_TRUE(deliver(handover, Way::kRaw, 1));
  handover.allow(Way::kShared);
  std_msgs::Header other = header(1);
  other.frame_id = "other";
  ASSERT_TRUE(handover.begin(Way::kShared, other));
  handover.finish();
}

TEST(FrameHandover, losesFewOfASenderWhoseHeadersAreAllTheSame)
{
  FrameHandover handover;
  for (int i = 0; i < 100; ++i)
    EXPECT_TRUE(deliver(handover, Way::kRaw, 0));
  handover.allow(Way::kShared);
  int delivered = 0;
  for (int i = 0; i < 100; ++i)
    delivered += deliver(handover, Way::kShared, 0) ? 1 : 0;
  EXPECT_GE(delivered, 99);
}

TEST(FrameHandover, aPermissionCanBeTakenBack)
{
  FrameHandover handover;
  handover.allow(Way::kShared);
  handover.allow(std::nullopt);
  EXPECT_FALSE(deliver(handover, Way::kShared, 1));
  handover.allow(Way::kShared);
  handover.take(Way::kRaw);
  EXPECT_FALSE(deliver(handover, Way::kShared, 1));
  EXPECT_EQ(handover.way(), Way::kRaw);
}

TEST(FrameHandover, deliversOneFrameAtATime)
{
  FrameHandover handover;
  constexpr int kFrames = 500;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  std::atomic<int> inside{0}, raw{0}, shared{0};
  const auto run = [&](Way way, std::uint32_t seq, std::atomic<int>& delivered)
  {
    // Each goes on until the other is done, too, so that they meet.
    while ((raw < kFrames || shared < kFrames) && std::chrono::steady_clock::now() < end)
    {
      handover.allow(way);
      if (!handover.begin(way, header(seq++))) continue;
      EXPECT_EQ(++inside, 1);
      std::this_thread::yield();
      --inside;
      ++delivered;
      handover.finish();
    }
  };
  std::thread other(run, Way::kShared, 1U << 31, std::ref(shared));
  run(Way::kRaw, 0, raw);
  other.join();
  EXPECT_GE(raw, kFrames);
  EXPECT_GE(shared, kFrames);
}

TEST(FrameHandover, itsEndWaitsForAFrameButNotInItsOwnCallback)
{
  FrameHandover handover;
  ASSERT_TRUE(handover.begin(Way::kRaw, header(1)));
  EXPECT_FALSE(handover.close());  // in the callback
  handover.finish();
  EXPECT_FALSE(deliver(handover, Way::kRaw, 2));

  FrameHandover other;
  std::atomic<bool> is_finished{false};
  ASSERT_TRUE(other.begin(Way::kRaw, header(1)));
  std::thread closes(
      [&]
      {
        EXPECT_TRUE(other.close());
        EXPECT_TRUE(is_finished);
      });
  while (other.accepts(Way::kRaw))  // until it is being closed
    std::this_thread::yield();
  is_finished = true;
  other.finish();
  closes.join();
}

}  // namespace
}  // namespace robot_vision
