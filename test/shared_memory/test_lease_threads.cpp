#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "processes.hpp"
#include "ros/shared_memory/lease_protocol.hpp"

/// The leases between threads that write and read the very same memory: this is what ThreadSanitizer can watch.

namespace lease = robot_vision::lease;

namespace
{

constexpr std::size_t kReaders = 3;
constexpr std::size_t kSlots = 3;
constexpr std::uint64_t kFrames = 20000;
constexpr std::uint64_t kMinRead = 500;

using Word = std::atomic<std::uint64_t>;

struct Slot
{
  Word generation{lease::kBusy};
  std::array<std::uint64_t, 64> pixels{};
};

struct Scene
{
  std::array<Slot, kSlots> slots;
  std::array<Word, kReaders> rows{};
  Word newest{0};  // generation and, in the lowest bits, slot
  std::atomic<bool> ending{false};
  std::atomic<std::uint64_t> read{0};
  std::atomic<std::uint64_t> torn{0};
};

void readFrames(Scene& scene, std::size_t reader)
{
  while (!scene.ending)
  {
    const std::uint64_t newest = scene.newest.load(std::memory_order_relaxed);
    const std::uint64_t bit = std::uint64_t{1} << newest % 8;
    const std::uint64_t generation = newest / 8;
    Slot& slot = scene.slots[newest % 8];
    if (generation == 0 || !lease::hold(scene.rows[reader], bit, slot.generation, generation)) continue;
    for (const std::uint64_t pixel : slot.pixels)
      if (pixel != generation) ++scene.torn;
    lease::release(scene.rows[reader], bit);
    ++scene.read;
  }
}

/// Publishes a frame in this slot, if it is free.
bool writeFrame(Scene& scene, std::size_t index, std::uint64_t& published, std::uint64_t generation)
{
  Slot& slot = scene.slots[index];
  const auto any_held = [&]
  {
    bool held = false;
    for (const Word& row : scene.rows)
      held |= (row.load(std::memory_order_acquire) >> index & 1) != 0;
    return held;
  };
  if (!lease::take(slot.generation, published, any_held)) return false;
  for (std::uint64_t& pixel : slot.pixels)
    pixel = generation;
  lease::publish(slot.generation, published = generation);
  scene.newest.store(generation * 8 + index, std::memory_order_relaxed);
  return true;
}

}  // namespace

TEST(LeaseThreads, neverReadWhatIsBeingWritten)
{
  Scene scene;
  std::vector<std::thread> readers;
  for (std::size_t reader = 0; reader < kReaders; ++reader)
    readers.emplace_back([&scene, reader] { readFrames(scene, reader); });
  std::array<std::uint64_t, kSlots> published;
  published.fill(lease::kBusy);
  std::uint64_t written = 0;
  const processes::Clock::time_point end = processes::Clock::now() + processes::kDeadline;
  for (std::uint64_t turn = 0; written < kFrames || scene.read < kMinRead; ++turn)
  {
    if (processes::Clock::now() > end) break;
    const std::size_t index = turn % kSlots;
    if (writeFrame(scene, index, published[index], 2 * written + 2)) ++written;
  }
  scene.ending = true;
  for (std::thread& thread : readers)
    thread.join();
  EXPECT_GE(written, kFrames);
  EXPECT_GE(scene.read, kMinRead);
  EXPECT_EQ(scene.torn, 0U);
  for (const Word& row : scene.rows)
    EXPECT_EQ(row, 0U);
}
