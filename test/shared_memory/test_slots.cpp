#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "processes.hpp"
#include "ros/shared_memory/slot_pool.hpp"
#include "ros/shared_memory/slot_reader.hpp"
#include "ros/shared_memory/slot_writer.hpp"

namespace
{

thread_local int interruptions = 0;  // of calls of fallocate() to come

}  // namespace

/// Takes the place of that of libc, which a signal interrupts.
int fallocate(int number, int mode, off_t offset, off_t bytes)
{
  if (interruptions == 0) return static_cast<int>(syscall(SYS_fallocate, number, mode, offset, bytes));
  --interruptions;
  errno = EINTR;
  return -1;
}

using namespace robot_vision;
using processes::fillFrame;
using processes::isWhole;
using processes::PatientReader;

namespace
{

constexpr std::size_t kBytes = 10000;

using Held = std::shared_ptr<const HeldSlot>;

SlotWriter::Limits limits(std::size_t max_slots, std::size_t max_bytes = std::size_t{1} << 24)
{
  SlotWriter::Limits made;
  made.max_slots = max_slots;
  made.max_bytes = max_bytes;
  return made;
}

/// Publishes a frame and gives it back; its address.
SlotAddress publish(SlotWriter& writer, std::uint64_t number, std::size_t bytes = kBytes)
{
  const std::shared_ptr<WritableSlot> slot = writer.take(bytes);
  if (!slot) throw std::runtime_error("no slot: " + writer.counts().reason);
  fillFrame(slot->data(), bytes, number);
  return slot->publish();
}

bool isFrame(const HeldSlot& held, std::uint64_t number, std::size_t bytes = kBytes)
{
  std::vector<std::uint8_t> expected(bytes, 0);
  fillFrame(expected.data(), bytes, number);
  return held.bytes() == bytes && std::memcmp(held.data(), expected.data(), bytes / 8 * 8) == 0;
}

/// Why this cannot be held; empty if it can.
std::string faultOf(SlotReader& reader, const SlotAddress& address)
{
  static const std::map<SharedMemoryFault, std::string> names = {{SharedMemoryFault::kOverwritten, "overwritten"},
                                                                 {SharedMemoryFault::kTooManyHeld, "too many"},
                                                                 {SharedMemoryFault::kGone, "gone"},
                                                                 {SharedMemoryFault::kOtherHost, "other host"},
                                                                 {SharedMemoryFault::kOtherUser, "other user"},
                                                                 {SharedMemoryFault::kUnreachable, "unreachable"},
                                                                 {SharedMemoryFault::kNoDescriptors, "no descriptor"},
                                                                 {SharedMemoryFault::kRefused, "refused"}};
  try
  {
    reader.hold(address);
  }
  catch (const SharedMemoryError& error)
  {
    return names.at(error.fault());
  }
  return "";
}

}  // namespace

TEST(Slots, readersSeeWhatWasWritten)
{
  SlotWriter writer;
  PatientReader reader;
  for (std::uint64_t number = 0; number < 20; ++number)
  {
    const SlotAddress address = publish(writer, number);
    EXPECT_EQ(address.bytes, kBytes);
    EXPECT_TRUE(isFrame(*reader.hold(address), number));
  }
  EXPECT_EQ(writer.counts().slots, SlotWriter::Limits().min_slots);
  EXPECT_EQ(writer.counts().dropped, 0U);
}

TEST(Slots, signalsDoNotKeepAFrameFromItsMemory)
{
  SlotWriter writer;
  PatientReader reader;
  constexpr std::size_t kLarge = (std::size_t{3} << 20) + 5;
  interruptions = 3;
  EXPECT_TRUE(isFrame(*reader.hold(publish(writer, 1, kLarge)), 1, kLarge));
  EXPECT_EQ(interruptions, 0);
}

TEST(Slots, whatAReaderHoldsOfATopicThatRestsDoesNotCountForAnother)
{
  const auto server = std::make_shared<SlotServer>();
  SlotWriter resting(limits(4), server), other(limits(4), server);
  PatientReader reader;
  std::vector<Held> held;
  for (std::uint64_t number = 0; number < 2; ++number)
    held.push_back(reader.hold(publish(resting, number)));
  resting.rest();
  for (std::uint64_t number = 0; number < 2; ++number)
    held.push_back(reader.hold(publish(other, number)));
  EXPECT_EQ(faultOf(reader, publish(other, 2)), "too many");
  std::vector<std::shared_ptr<WritableSlot>> writing;
  while (const auto slot = other.take(kBytes))
    writing.push_back(slot);
  EXPECT_EQ(other.readers(), 1U);
  for (std::size_t i = 0; i < held.size(); ++i)
    EXPECT_TRUE(isFrame(*held[i], i % 2));
}

TEST(Slots, framesWithoutPixelsAreFrames)
{
  SlotWriter writer;
  PatientReader reader;
  EXPECT_EQ(reader.hold(publish(writer, 1, 0))->bytes(), 0U);
}

TEST(Slots, theNewestFramesAreThereForReadersThatComeLate)
{
  SlotWriter writer;
  PatientReader reader;
  std::vector<SlotAddress> addresses;
  for (std::uint64_t number = 0; number < 40; ++number)
    addresses.push_back(publish(writer, number));
  const std::size_t newest = SlotWriter::Limits().min_slots;
  for (std::size_t number = 40 - newest; number < 40; ++number)
    EXPECT_TRUE(isFrame(*reader.hold(addresses[number]), number));
  EXPECT_EQ(faultOf(reader, addresses[40 - newest - 1]), "overwritten");
}

TEST(Slots, heldFramesAreNeverOverwritten)
{
  SlotWriter writer(limits(20));
  PatientReader reader;
  std::map<std::uint64_t, Held> held;
  for (std::uint64_t number = 0; number < 100; ++number)
  {
    const SlotAddress address = publish(writer, number);
    if (number % 12 == 0) held[number] = reader.hold(address);
  }
  EXPECT_EQ(held.size(), 9U);
  for (const auto& [number, frame] : held)
    EXPECT_TRUE(isFrame(*frame, number));
  EXPECT_LE(writer.counts().slots, held.size() + SlotWriter::Limits().min_slots);
}

TEST(Slots, framesAreDroppedAndCountedWhenAllSlotsAreHeld)
{
  SlotWriter writer(limits(6));
  std::vector<std::shared_ptr<WritableSlot>> in_use;
  for (int i = 0; i < 6; ++i)
    in_use.push_back(writer.take(kBytes));
  EXPECT_FALSE(writer.take(kBytes));
  EXPECT_FALSE(writer.take(kBytes));
  EXPECT_EQ(writer.counts().slots, 6U);
  EXPECT_EQ(writer.counts().dropped, 2U);
  EXPECT_NE(writer.counts().reason.find("all 6 slots"), std::string::npos) << writer.counts().reason;
  in_use.pop_back();
  EXPECT_TRUE(writer.take(kBytes));
}

TEST(Slots, theirBytesAreLimited)
{
  SlotWriter writer(limits(100, 1 << 20));
  std::vector<std::shared_ptr<WritableSlot>> in_use;
  while (auto slot = writer.take(200000))
    in_use.push_back(slot);
  EXPECT_EQ(in_use.size(), 5U);
  EXPECT_LE(writer.counts().bytes, 1U << 20);
  EXPECT_FALSE(writer.take(2 << 20));
  EXPECT_NE(writer.counts().reason.find("2097152 bytes is beyond the limit"), std::string::npos);
  EXPECT_FALSE(writer.take(~std::size_t{0}));
}

TEST(Slots, oneReaderHoldsAtMostHalf)
{
  SlotWriter writer(limits(8));
  PatientReader reader;
  std::vector<Held> held;
  for (std::uint64_t number = 0; number < 4; ++number)
    held.push_back(reader.hold(publish(writer, number)));
  const SlotAddress another = publish(writer, 4);
  EXPECT_EQ(faultOf(reader, another), "too many");
  held.erase(held.begin());
  EXPECT_EQ(faultOf(reader, another), "");
  EXPECT_TRUE(isFrame(*held.front(), 1));
}

TEST(Slots, oneReaderHoldsAtMostHalfOfTheBytes)
{
  SlotWriter writer(limits(100, 1 << 20));
  PatientReader reader;
  std::vector<Held> held;
  for (std::uint64_t number = 0; number < 2; ++number)
    held.push_back(reader.hold(publish(writer, number, 200000)));
  EXPECT_EQ(faultOf(reader, publish(writer, 2, 200000)), "too many");
}

TEST(Slots, thisProcessHoldsToo)
{
  SlotWriter writer(limits(12));
  const std::shared_ptr<WritableSlot> kept = writer.take(kBytes);
  fillFrame(kept->data(), kBytes, 77);
  const SlotAddress address = kept->publish();
  for (std::uint64_t number = 0; number < 50; ++number)
    publish(writer, number);
  PatientReader reader;
  EXPECT_TRUE(isFrame(*reader.hold(address), 77));
  EXPECT_EQ(kept->publish().generation, address.generation);
}

TEST(Slots, whatWasNotPublishedCannotBeHeld)
{
  SlotWriter writer;
  PatientReader reader;
  SlotAddress address = publish(writer, 0);
  const std::shared_ptr<WritableSlot> unpublished = writer.take(kBytes);
  for (std::uint32_t slot = 0; slot < 2; ++slot)
    for (std::uint64_t generation = 0; generation < 20; ++generation)
    {
      SlotAddress guess = address;
      guess.slot = slot;
      guess.memory = slot + 1;
      guess.generation = generation;
      EXPECT_EQ(faultOf(reader, guess).empty(), slot == 0 && generation == address.generation) << generation;
    }
}

TEST(Slots, anotherSizeIsOtherMemory)
{
  SlotWriter writer;
  PatientReader reader;
  const SlotAddress old_address = publish(writer, 1, 5000000);
  const Held old_frame = reader.hold(old_address);
  std::uint64_t number = 2;
  for (const std::size_t bytes : {4000, 300000, 8})
  {
    for (int i = 0; i < 6; ++i, ++number)
      EXPECT_TRUE(isFrame(*reader.hold(publish(writer, number, bytes)), number, bytes));
    EXPECT_TRUE(isFrame(*old_frame, 1, 5000000));
  }
  EXPECT_LT(writer.counts().bytes, 5100000U);  // what is held, and what is needed now
}

TEST(Slots, memoryOfAnotherSizeIsFreed)
{
  SlotWriter writer;
  PatientReader reader;
  for (std::uint64_t number = 0; number < 6; ++number)
    reader.hold(publish(writer, number, 5000000));
  for (std::uint64_t number = 0; number < 6; ++number)
    reader.hold(publish(writer, number, 4096));
  EXPECT_EQ(writer.counts().slots, 4U);
  EXPECT_LT(writer.counts().bytes, 50000U);
  EXPECT_EQ(processes::mappedMemory(), 4U + 4U + 2U);  // the writer's, the reader's, and the row, which both have
}

TEST(Slots, memoryThatIsNeededNoLongerIsFreed)
{
  SlotWriter writer;
  {
    std::vector<std::shared_ptr<WritableSlot>> in_use;
    for (int i = 0; i < 20; ++i)
      in_use.push_back(writer.take(kBytes));
  }
  EXPECT_EQ(writer.counts().slots, 20U);
  for (std::uint64_t number = 0; number < 2 * SlotPool::kMaxIdleTakes; ++number)
    publish(writer, number);
  EXPECT_EQ(writer.counts().slots, SlotWriter::Limits().min_slots);
}

TEST(Slots, theMemoryOfAWriterThatRestsIsGivenBackButForWhatIsHeld)
{
  SlotWriter writer;
  PatientReader reader;
  const Held held = reader.hold(publish(writer, 1));
  auto in_use = writer.take(kBytes);
  publish(writer, 2);
  EXPECT_EQ(writer.counts().slots, 3U);
  writer.rest();
  EXPECT_EQ(writer.counts().slots, 1U);
  in_use.reset();
  EXPECT_EQ(writer.counts().slots, 0U);
  EXPECT_EQ(writer.counts().bytes, 0U);
  EXPECT_TRUE(isFrame(*held, 1));
  // What the reader holds, and the row; that of another test may still be there for a moment.
  EXPECT_TRUE(processes::becomes([] { return processes::mappedMemory() == 1U + 2U; })) << processes::mappedMemory();
  EXPECT_TRUE(isFrame(*reader.hold(publish(writer, 3)), 3));
  EXPECT_EQ(writer.counts().slots, 1U);  // it rests no longer
}

TEST(Slots, aFrameOutlivesItsReaderAndItsWriter)
{
  auto reader = std::make_unique<PatientReader>();
  auto writer = std::make_unique<SlotWriter>();
  const SlotAddress address = publish(*writer, 5);
  const Held held = reader->hold(address);
  auto writable = writer->take(kBytes);
  writer.reset();
  std::memset(writable->data(), 1, kBytes);
  EXPECT_NE(writable->publish().generation, 0U);
  reader.reset();
  writable.reset();
  EXPECT_TRUE(isFrame(*held, 5));
  PatientReader other;
  EXPECT_NE(faultOf(other, address), "");
}

TEST(Slots, readersOfOneProcessShareAConnection)
{
  SlotWriter writer;
  PatientReader first;
  PatientReader second;
  const SlotAddress address = publish(writer, 1);
  const Held a = first.hold(address);
  const Held b = second.hold(address);
  EXPECT_EQ(a->data(), b->data());
  EXPECT_EQ(writer.readers(), 1U);
}

TEST(Slots, aSlotIsHeldUntilItsLastHolderEnds)
{
  SlotWriter writer(limits(6));
  PatientReader reader;
  const SlotAddress address = publish(writer, 1);
  Held a = reader.hold(address);
  const Held b = reader.hold(address);
  a.reset();
  for (std::uint64_t number = 2; number < 30; ++number)
    publish(writer, number);
  EXPECT_TRUE(isFrame(*b, 1));
}

TEST(Slots, readersCannotWrite)
{
  SlotWriter writer;
  PatientReader reader;
  const Held held = reader.hold(publish(writer, 1));
  auto* page = const_cast<std::uint8_t*>(held->data());
  EXPECT_EQ(mprotect(page, 4096, PROT_READ | PROT_WRITE), -1);
  EXPECT_EQ(errno, EACCES);
}

TEST(Slots, pixelsInASlotAreRecognized)
{
  SlotWriter writer;
  std::shared_ptr<WritableSlot> slot = writer.take(kBytes);
  const std::uint8_t* pixels = slot->data();
  EXPECT_EQ(findSlot(pixels), slot);
  EXPECT_EQ(findSlot(pixels + 1), nullptr);
  slot.reset();
  EXPECT_EQ(findSlot(pixels), nullptr);
}

TEST(Slots, addressesThatCannotBeAreRefused)
{
  SlotWriter writer;
  PatientReader reader;
  const SlotAddress good = publish(writer, 1);
  const auto fault_with = [&](auto change)
  {
    SlotAddress address = good;
    change(address);
    return faultOf(reader, address);
  };
  PatientReader unconnected;
  SlotAddress elsewhere = good;
  elsewhere.boot_id = "7";
  EXPECT_EQ(faultOf(unconnected, elsewhere), "other host");
  EXPECT_EQ(faultOf(reader, good), "");
  EXPECT_EQ(fault_with([](auto& address) { address.socket = "/tmp/dbus"; }), "refused");
  EXPECT_EQ(fault_with([](auto& address) { address.socket = std::string(100000, 'a'); }), "refused");
  EXPECT_EQ(fault_with([](auto& address) { address.socket.back() = address.socket.back() == '0' ? '1' : '0'; }),
            "unreachable");
  EXPECT_EQ(fault_with([](auto& address) { address.publisher += 1; }), "refused");
  EXPECT_EQ(fault_with([](auto& address) { address.slot = 1024; }), "refused");
  EXPECT_EQ(fault_with([](auto& address) { address.slot = 0xffffffff; }), "refused");
  EXPECT_EQ(fault_with([](auto& address) { address.slot += 1; }), "overwritten");
  EXPECT_EQ(fault_with([](auto& address) { address.memory += 1; }), "overwritten");
  EXPECT_EQ(fault_with([](auto& address) { address.generation += 1; }), "refused");
  EXPECT_EQ(fault_with([](auto& address) { address.generation = ~std::uint64_t{0}; }), "refused");
  EXPECT_EQ(fault_with([](auto& address) { address.generation += 2; }), "overwritten");
  EXPECT_EQ(fault_with([](auto& address) { address.bytes = 4096 * 3 + 1; }), "refused");
  EXPECT_EQ(fault_with([](auto& address) { address.bytes = ~std::uint64_t{0}; }), "refused");
  EXPECT_EQ(faultOf(reader, good), "");
}

TEST(Slots, areForAnyNumberOfThreads)
{
  SlotWriter writer;
  PatientReader reader;
  processes::Board board;
  std::atomic<bool> ending{false};
  std::vector<std::thread> readers;
  for (int i = 0; i < 3; ++i)
    readers.emplace_back(
        [&]
        {
          while (!ending)
            if (const auto address = board.newest()) try
              {
                const Held held = reader.hold(*address);
                ++(isWhole(held->data(), held->bytes()) ? board.held : board.torn);
              }
              catch (const SharedMemoryError& error)
              {
                if (!error.concernsOneFrame()) ++board.torn;
              }
        });
  const processes::Clock::time_point end = processes::Clock::now() + processes::kDeadline;
  for (std::uint64_t number = 0; board.held < 2000 && processes::Clock::now() < end; ++number)
    board.post(publish(writer, number));
  ending = true;
  for (std::thread& thread : readers)
    thread.join();
  EXPECT_GE(board.held, 2000U);
  EXPECT_EQ(board.torn, 0U);
}
