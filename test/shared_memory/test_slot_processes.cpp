#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "processes.hpp"
#include "ros/shared_memory/seqpacket.hpp"
#include "ros/shared_memory/slot_reader.hpp"
#include "ros/shared_memory/slot_writer.hpp"

/// What happens to processes: they are stopped, forked, restarted, many, of other users, and short of descriptors.

using namespace robot_vision;
using processes::becomes;
using processes::Board;
using processes::Child;
using processes::fillFrame;
using processes::isWhole;
using processes::kDeadline;
using processes::openDescriptors;
using processes::PatientReader;
using processes::Shared;

namespace
{

constexpr std::size_t kBytes = 32768;
constexpr uid_t kNobody = 65534;

using Held = std::shared_ptr<const HeldSlot>;

void publish(SlotWriter& writer, Board& board, std::uint64_t number, std::size_t bytes = kBytes)
{
  const std::shared_ptr<WritableSlot> slot = writer.take(bytes);
  if (!slot) throw std::runtime_error("no slot: " + writer.counts().reason);
  fillFrame(slot->data(), bytes, number);
  board.post(slot->publish());
}

bool readNewest(SlotReader& reader, Board& board, Held& held)
{
  const auto address = board.newest();
  if (!address) return false;
  try
  {
    held = reader.hold(*address);
  }
  catch (const SharedMemoryError&)
  {
    return false;
  }
  ++(isWhole(held->data(), held->bytes()) ? board.held : board.torn);
  return true;
}

/// What there is to say of the newest frame; empty if it can be held.
std::string reasonAt(Board& board)
{
  PatientReader reader;
  try
  {
    reader.hold(*board.newest());
  }
  catch (const SharedMemoryError& error)
  {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part)
{
  if (text.find(part) != std::string::npos) return true;
  std::fprintf(stderr, "'%s' has no '%s'\n", text.c_str(), part.c_str());
  return false;
}

}  // namespace

TEST(StoppedReaders, keepTheirFramesAndHoldUpNobody)
{
  Shared<Board> board;
  SlotWriter writer;
  publish(writer, *board, 1);
  Child reader(
      [&]
      {
        PatientReader slots;
        Held held;
        std::vector<Held> all(8);
        for (std::size_t i = 0;; ++i)
        {
          Held& oldest = all[i % all.size()];
          if (oldest && !isWhole(oldest->data(), oldest->bytes())) ++board->torn;
          readNewest(slots, *board, oldest);
        }
        return 0;
      });
  EXPECT_TRUE(becomes(
      [&]
      {
        publish(writer, *board, board->held + 1);
        return board->held > 50;
      }));
  for (int stops = 0; stops < 20; ++stops)
  {
    reader.signal(SIGSTOP);
    for (std::uint64_t number = 0; number < 500; ++number)
      publish(writer, *board, number);
    const std::uint64_t before = board->held;
    reader.signal(SIGCONT);
    EXPECT_TRUE(becomes(
        [&]
        {
          publish(writer, *board, 7);
          return board->held > before + 10;
        }));
  }
  EXPECT_EQ(writer.counts().dropped, 0U);
  EXPECT_EQ(board->torn, 0U);
  EXPECT_FALSE(reader.kill()) << "it had ended by itself";
}

TEST(Publishers, thatAreRestartedWithAnotherSizeAreReadOn)
{
  Shared<Board> board;
  PatientReader reader;
  Held held;
  for (const std::size_t bytes : {640 * 480 * 3, 1920 * 1080, 8, 100000})
  {
    Child publisher(
        [&]
        {
          SlotWriter writer;
          for (std::uint64_t number = 0;; ++number)
            publish(writer, *board, number, bytes);
          return 0;
        });
    EXPECT_TRUE(becomes([&] { return readNewest(reader, *board, held) && held->bytes() == bytes; }));
  }
  EXPECT_EQ(board->torn, 0U);
}

TEST(ManyReaders, areAllServed)
{
  constexpr int kReaders = 100;
  constexpr int kFrames = 10;                       // for each
  constexpr std::chrono::milliseconds kPeriod{10};  // so that they take turns
  const std::size_t descriptors = openDescriptors();
  Shared<Board> board;
  SlotWriter::Limits limits;
  limits.max_slots = 128;  // some processors for all of them: each may be halted while it holds another frame
  {
    SlotWriter writer(limits);
    std::vector<Child> readers;
    readers.reserve(kReaders);
    for (int i = 0; i < kReaders; ++i)
      readers.emplace_back(
          [&]
          {
            PatientReader slots;
            Held held;
            int whole = 0;
            const auto has_enough = [&]
            {
              whole += readNewest(slots, *board, held) ? 1 : 0;
              return whole >= kFrames;
            };
            // It goes on holding the last until all are there.
            const auto all_have = [&] { return board->held >= kFrames * kReaders; };
            return becomes(has_enough, kDeadline, kPeriod) && becomes(all_have, kDeadline, kPeriod) ? 0 : 1;
          });
    std::uint64_t number = 0;
    EXPECT_TRUE(becomes(
        [&]
        {
          publish(writer, *board, ++number);
          return board->held >= kFrames * kReaders;
        }));
    for (Child& reader : readers)
      EXPECT_EQ(reader.wait(), 0);
    EXPECT_EQ(board->torn, 0U);
    EXPECT_EQ(writer.counts().dropped, 0U);
    EXPECT_TRUE(becomes([&] { return writer.readers() == 0; }));
  }
  EXPECT_EQ(openDescriptors(), descriptors);
}

TEST(ForkedChildren, doNotGiveBackWhatTheirParentsHold)
{
  Shared<Board> board;
  SlotWriter writer;
  PatientReader reader;
  publish(writer, *board, 1);
  Held held = reader.hold(*board->newest());
  std::shared_ptr<WritableSlot> in_use = writer.take(kBytes);
  fillFrame(in_use->data(), kBytes, 2);
  const SlotAddress address = in_use->publish();
  Child child(
      [&]
      {
        if (!isWhole(held->data(), held->bytes())) return 1;
        held.reset();
        in_use.reset();
        if (writer.take(kBytes)) return 2;
        if (writer.readers() != 0 || writer.counts().slots != 0) return 3;
        try
        {
          reader.hold(address);
          return 4;
        }
        catch (const SharedMemoryError& error)
        {
          if (!contains(error.what(), "parent")) return 5;
        }
        return 0;
      });
  EXPECT_EQ(child.wait(), 0);
  for (std::uint64_t number = 3; number < 50; ++number)
    publish(writer, *board, number);
  EXPECT_TRUE(isWhole(held->data(), held->bytes()));
  EXPECT_EQ(*reinterpret_cast<const std::uint64_t*>(held->data()), 0x9e3779b97f4a7c15U);
  EXPECT_EQ(*reinterpret_cast<const std::uint64_t*>(in_use->data()), 2 * 0x9e3779b97f4a7c15U);
  EXPECT_EQ(writer.readers(), 1U);
}

TEST(ForkedChildren, haveSlotsAndReadersOfTheirOwn)
{
  Shared<Board> board;
  Shared<Board> of_child;
  SlotWriter writer;
  PatientReader reader;
  publish(writer, *board, 1);
  const Held held = reader.hold(*board->newest());
  Child child(
      [&]
      {
        PatientReader readers_own;
        Held of_parent;
        if (!readNewest(readers_own, *board, of_parent)) return 1;
        SlotWriter writers_own;
        for (std::uint64_t number = 0; of_child->held < 20; ++number)
          publish(writers_own, *of_child, number);
        return 0;
      });
  Held of_child_held;
  EXPECT_TRUE(becomes([&] { return readNewest(reader, *of_child, of_child_held) && of_child->held >= 20; }));
  of_child_held.reset();
  EXPECT_EQ(child.wait(), 0);
  EXPECT_EQ(board->torn + of_child->torn, 0U);
}

TEST(ForkedChildren, giveTheirOwnFilesToTheirOwnChildren)
{
  Shared<Board> board;
  SlotWriter writer;
  PatientReader reader;
  publish(writer, *board, 1);
  const Held held = reader.hold(*board->newest());
  Child parent(
      []
      {
        // They get the numbers that what the process had before has left.
        std::vector<int> files(64);
        for (int& file : files)
          file = open("/dev/null", O_RDONLY);
        Child child(
            [&files]
            {
              const auto is_open = [](int file) { return fcntl(file, F_GETFD) >= 0; };
              return std::all_of(files.begin(), files.end(), is_open) ? 0 : 1;
            });
        return child.wait();
      });
  EXPECT_EQ(parent.wait(), 0);
}

TEST(ForkedChildren, doNotKeepTheirParentsConnected)
{
  Shared<Board> board;
  SlotWriter writer;
  publish(writer, *board, 1);
  const bool adopts = prctl(PR_SET_CHILD_SUBREAPER, 1) == 0;  // the orphan; under QEMU's emulation it is init's child
  Child parent(
      [&]
      {
        PatientReader reader;
        const Held held = reader.hold(*board->newest());
        Child child(
            [&]
            {
              prctl(PR_SET_PDEATHSIG, 0);  // it outlives its parent
              board->held = static_cast<std::uint64_t>(getpid());
              return pause();
            });
        return pause();
      });
  EXPECT_TRUE(becomes([&] { return board->held > 0; }));
  EXPECT_EQ(writer.readers(), 1U);
  parent.kill();
  EXPECT_TRUE(becomes([&] { return writer.readers() == 0; }, std::chrono::seconds(10)));
  const auto orphan = static_cast<pid_t>(board->held);
  EXPECT_EQ(kill(orphan, SIGKILL), 0);
  if (adopts)
  {
    EXPECT_EQ(waitpid(orphan, nullptr, 0), orphan);
  }
}

TEST(OtherUsers, getNothing)
{
  if (geteuid() != 0) GTEST_SKIP() << "only root can be another user";
  Shared<Board> board;
  {
    SlotWriter writer;
    publish(writer, *board, 1);
    Child nobody(
        [&]
        {
          if (setuid(kNobody) != 0) return 1;
          if (!contains(reasonAt(*board), "another user's")) return 2;
          // The publisher's side looks, too.
          const Descriptor socket = connectTo(board->newest()->socket, 10);
          char byte;
          return recv(socket.get(), &byte, 1, 0) == 0 ? 0 : 3;
        });
    EXPECT_EQ(nobody.wait(), 0);
    EXPECT_EQ(writer.readers(), 0U);
  }
  Child publisher(
      [&]
      {
        if (setuid(kNobody) != 0) return 1;
        SlotWriter writer;
        publish(writer, *board, 1);
        ++board->held;
        return pause();
      });
  EXPECT_TRUE(becomes([&] { return board->held == 1; }));
  EXPECT_TRUE(contains(reasonAt(*board), "another user's"));
}

TEST(OtherNetworks, areOutOfReach)
{
  Shared<Board> board;
  SlotWriter writer;
  publish(writer, *board, 1);
  Child container(
      [&]
      {
        if (unshare(CLONE_NEWNET) != 0) return 77;
        return contains(reasonAt(*board), "no connection to the publisher's socket") ? 0 : 1;
      });
  const int code = container.wait();
  if (code == 77) GTEST_SKIP() << "no network namespace can be made here";
  EXPECT_EQ(code, 0);
}

TEST(ShortOfDescriptors, publishersDropFramesForAReasonAndGoOnLater)
{
  Child publisher(
      []
      {
        const rlimit limit{64, 64};
        setrlimit(RLIMIT_NOFILE, &limit);
        SlotWriter::Limits limits;
        limits.max_slots = 100;
        SlotWriter writer(limits);
        std::vector<std::shared_ptr<WritableSlot>> in_use;
        while (auto slot = writer.take(kBytes))
          in_use.push_back(slot);
        if (in_use.size() < 20 || !contains(writer.counts().reason, "Too many open files")) return 1;
        const std::size_t descriptors = openDescriptors();
        for (int i = 0; i < 100; ++i)
          if (writer.take(kBytes)) return 2;
        if (openDescriptors() != descriptors || writer.counts().dropped != 101) return 3;
        SlotWriter another;
        if (another.take(kBytes) || !contains(another.counts().reason, "Too many open files")) return 4;
        in_use.clear();
        for (int i = 0; i < 100; ++i)
          if (!writer.take(kBytes)) return 5;
        return 0;
      });
  EXPECT_EQ(publisher.wait(), 0);
}

TEST(ShortOfDescriptors, readersSaySoAndGoOnLater)
{
  Shared<Board> board;
  SlotWriter writer;
  publish(writer, *board, 1);
  Child reader(
      [&]
      {
        const rlimit limit{64, 64};
        setrlimit(RLIMIT_NOFILE, &limit);
        for (const int left : {0, 1, 2})
        {
          std::vector<Descriptor> used;
          for (int number = dup(0); number >= 0; number = dup(0))
            used.emplace_back(number);
          for (int i = 0; i < left; ++i)
            used.pop_back();
          const std::size_t descriptors = openDescriptors();
          for (int i = 0; i < 30; ++i)
          {
            const std::string reason = reasonAt(*board);
            if (left < 2 ? !contains(reason, "Too many open files") : !reason.empty()) return 1 + left;
          }
          if (openDescriptors() != descriptors) return 4;
        }
        return reasonAt(*board).empty() ? 0 : 10;
      });
  EXPECT_EQ(reader.wait(), 0);
}

TEST(ShortOfDescriptors, publishersTurnReadersAwayAndGoOn)
{
  Shared<Board> board;
  Child publisher(
      [&]
      {
        SlotWriter writer;
        for (std::uint64_t number = 0; number < 5; ++number)
          publish(writer, *board, number);
        const rlimit limit{64, 64};
        setrlimit(RLIMIT_NOFILE, &limit);
        std::vector<Descriptor> used;
        for (int number = dup(0); number >= 0; number = dup(0))
          used.emplace_back(number);
        ++board->held;
        if (!becomes([&] { return board->held >= 2; })) return 1;
        used.clear();
        ++board->held;
        return pause();
      });
  ASSERT_TRUE(becomes([&] { return board->held == 1; }));
  for (int i = 0; i < 10; ++i)
    EXPECT_TRUE(contains(reasonAt(*board), "closed the connection"));
  ++board->held;
  ASSERT_TRUE(becomes([&] { return board->held == 3; }));
  EXPECT_EQ(reasonAt(*board), "");
}
