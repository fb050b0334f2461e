#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "processes.hpp"
#include "ros/shared_memory/slot_reader.hpp"
#include "ros/shared_memory/slot_writer.hpp"

using namespace robot_vision;
using namespace processes;

namespace
{

#ifdef __SANITIZE_ADDRESS__
constexpr int kKills = 100;  // a fork takes ten times as long
#else
constexpr int kKills = 1000;
#endif
constexpr std::size_t kBytes = 32768;  // of a frame: a torn one is seen, and reading it does not take long

std::shared_ptr<WritableSlot> publishFrame(SlotWriter& writer, Board& board, std::uint64_t number,
                                           std::size_t bytes = kBytes)
{
  std::shared_ptr<WritableSlot> slot = writer.take(bytes);
  if (!slot) return slot;
  fillFrame(slot->data(), bytes, number);
  board.post(slot->publish());
  return slot;
}

/// Holds the newest frame and looks at it twice. Null if there was none to be had.
std::shared_ptr<const HeldSlot> readFrame(SlotReader& reader, Board& board)
{
  const std::optional<SlotAddress> address = board.newest();
  if (!address) return nullptr;
  try
  {
    std::shared_ptr<const HeldSlot> held = reader.hold(*address);
    const bool whole = isWhole(held->data(), held->bytes()) && isWhole(held->data(), held->bytes());
    ++(whole ? board.held : board.torn);
    return held;
  }
  catch (const SharedMemoryError&)
  {
    return nullptr;
  }
}

/// Reads for ever, and always has some frames in hand.
int readForEver(Board& board)
{
  PatientReader reader;
  std::vector<std::shared_ptr<const HeldSlot>> in_hand(3);
  for (std::size_t turn = 0;; ++turn)
  {
    auto& oldest = in_hand[turn % in_hand.size()];
    if (oldest && !isWhole(oldest->data(), oldest->bytes())) ++board.torn;
    oldest = readFrame(reader, board);
  }
}

int publishForEver(Board& board, std::size_t bytes)
{
  SlotWriter writer;
  for (std::uint64_t number = 1;; ++number)
    publishFrame(writer, board, number, bytes);
}

}  // namespace

TEST(KilledProcesses, readersLeaveNothingBehind)
{
  const std::size_t descriptors = openDescriptors();
  std::mt19937 random(1);
  Shared<Board> board;
  {
    SlotWriter writer;
    std::uint64_t number = 0;
    const auto publish_until = [&](Clock::time_point end)
    {
      do
        publishFrame(writer, *board, ++number);
      while (Clock::now() < end);
    };
    std::vector<Child> readers;
    for (int kills = 0; kills < kKills; ++kills)
    {
      readers.emplace_back([&] { return readForEver(*board); });
      const auto delay = std::chrono::microseconds(random() % 3000);
      publish_until(Clock::now() + delay);
      if (readers.size() < 2) continue;
      const std::size_t victim = random() % readers.size();
      std::swap(readers[victim], readers.back());
      EXPECT_FALSE(readers.back().kill()) << "it had ended by itself";
      readers.pop_back();
      // What the dead ones hold comes back when the server's thread has a core.
      ASSERT_TRUE(becomes([&] { return writer.readers() <= readers.size() + 2; }));
    }
    readers.clear();
    EXPECT_TRUE(becomes([&] { return writer.readers() == 0; }, std::chrono::seconds(10)));
    EXPECT_EQ(board->torn, 0U);
    EXPECT_GT(board->held, static_cast<std::uint64_t>(kKills));
    EXPECT_EQ(writer.counts().dropped, 0U);
    // All slots are free again: as many as there may be are there at once.
    std::vector<std::shared_ptr<WritableSlot>> all;
    for (std::size_t i = 0; i < SlotWriter::Limits().max_slots; ++i)
      all.push_back(writer.take(kBytes));
    EXPECT_TRUE(all.back());
    EXPECT_EQ(writer.counts().slots, SlotWriter::Limits().max_slots);
  }
  EXPECT_EQ(openDescriptors(), descriptors);
  EXPECT_EQ(mappedMemory(), 0U);
}

TEST(KilledProcesses, publishersLeaveNothingBehindAndTheirFramesWhole)
{
  const std::size_t descriptors = openDescriptors();
  std::mt19937 random(2);
  Shared<Board> board;
  {
    PatientReader reader;
    std::shared_ptr<const HeldSlot> kept;
    for (int kills = 0; kills < kKills; ++kills)
    {
      // Another size each time, as a publisher that is restarted may have.
      Child publisher([&] { return publishForEver(*board, kBytes + 4096 * (kills % 3)); });
      const bool early = random() % 4 == 0;  // before it has published anything, as a rule
      std::uint64_t wanted = early ? 0 : board->held + random() % 20 + 1;
      const auto end = Clock::now() + std::chrono::microseconds(random() % 3000);
      const bool read = becomes(
          [&]
          {
            if (auto frame = readFrame(reader, *board)) kept = frame;
            return early ? Clock::now() > end : board->held >= wanted;
          });
      EXPECT_TRUE(read) << "no frame after kill " << kills;
      EXPECT_FALSE(publisher.kill()) << "it had ended by itself";
      if (kept) EXPECT_TRUE(isWhole(kept->data(), kept->bytes()));
    }
    EXPECT_EQ(board->torn, 0U);
    kept.reset();
    reader.forgetEnded();
    EXPECT_EQ(openDescriptors(), descriptors);
    EXPECT_EQ(mappedMemory(), 0U);
  }
}
