#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "processes.hpp"
#include "ros/shared_memory/memory_file.hpp"
#include "ros/shared_memory/seqpacket.hpp"
#include "ros/shared_memory/slot_names.hpp"
#include "ros/shared_memory/slot_packets.hpp"
#include "ros/shared_memory/slot_reader.hpp"
#include "ros/shared_memory/slot_writer.hpp"

/// Processes of the same user that do not keep to what they ought to do.

namespace
{

std::atomic<bool> has_descriptors{true};
std::atomic<int> accepts{0};  // calls of accept4()

}  // namespace

/// Takes the place of that of libc.
int accept4(int socket, sockaddr* address, socklen_t* length, int flags)
{
  ++accepts;
  if (has_descriptors) return static_cast<int>(syscall(SYS_accept4, socket, address, length, flags));
  errno = EMFILE;
  return -1;
}

using namespace robot_vision;
using processes::becomes;
using processes::openDescriptors;
using processes::PatientReader;

namespace
{

constexpr std::size_t kBytes = 10000;
constexpr int kShrink = F_SEAL_SHRINK;
constexpr int kFutureWrite = 0x10;

SlotAddress publish(SlotWriter& writer)
{
  const std::shared_ptr<WritableSlot> slot = writer.take(kBytes);
  if (!slot) throw std::runtime_error("no slot: " + writer.counts().reason);
  return slot->publish();
}

/// A memfd of this size, of which the pages up to `filled` are there.
Descriptor memory(std::size_t bytes, std::size_t filled, int seals, unsigned flags = 0)
{
  Descriptor made(memfd_create("foreign", MFD_CLOEXEC | MFD_ALLOW_SEALING | flags));
  if (ftruncate(made.get(), static_cast<off_t>(bytes)) != 0) throw std::runtime_error("no memory");
  if (filled > 0 && fallocate(made.get(), 0, 0, static_cast<off_t>(filled)) != 0) throw std::runtime_error("no pages");
  if (seals != 0) fcntl(made.get(), F_ADD_SEALS, seals);
  return made;
}

Descriptor goodMemory(std::size_t bytes)
{
  return memory(bytes, bytes, kShrink | kFutureWrite);
}

/// Whether the other end closes the connection.
bool isClosed(const Descriptor& socket)
{
  return becomes(
      [&]
      {
        char byte;
        const ssize_t got = recv(socket.get(), &byte, 1, MSG_DONTWAIT);
        return got == 0 || (got < 0 && errno != EAGAIN);
      });
}

/// A reader that has been welcomed.
struct Guest
{
  explicit Guest(const SlotAddress& address)
    : socket(connectTo(address.socket, 10)), row(makeMemoryFile("row", kRowBytes))
  {
    SlotGreeting greeting;
    greeting.publisher = address.publisher;
    send(socket, greeting, row.descriptor);
    SlotWelcome welcome;
    Descriptor passed;
    if (receive(socket, welcome, passed) != Received::kPacket) throw std::runtime_error("not welcome");
  }
  SharedWord* words() { return reinterpret_cast<SharedWord*>(row.mapping.data()); }

  Descriptor socket;
  MemoryFile row;
};

/// A publisher that does what a test says with each reader's socket.
class Host
{
public:
  explicit Host(std::function<void(Descriptor&)> treat) : socket_(listenAt(name()))
  {
    address.boot_id = bootId();
    address.socket = name_;
    address.publisher = 42;
    address.memory = 1;
    address.generation = 2;
    address.bytes = kBytes;
    thread_ = std::thread(
        [this, treat = std::move(treat)]
        {
          for (;;)
          {
            Descriptor reader(accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC));
            if (!reader || ending_) return;
            treat(reader);
          }
        });
  }
  ~Host()
  {
    ending_ = true;
    shutdown(socket_.get(), SHUT_RDWR);
    thread_.join();
  }
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  SlotAddress address;

private:
  const std::string& name()
  {
    static std::uint64_t number = static_cast<std::uint64_t>(getpid()) << 32;
    if (name_.empty()) name_ = slotSocketName(1, ++number);
    return name_;
  }

  std::string name_;
  Descriptor socket_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

void waitForEnd(Descriptor& reader)
{
  pollfd polled{reader.get(), POLLRDHUP, 0};
  poll(&polled, 1, 60000);
}

/// Greets a reader as it must be.
void welcome(Descriptor& reader)
{
  SlotGreeting greeting;
  Descriptor row;
  receive(reader, greeting, row);
  SlotWelcome packet;
  packet.publisher = 42;
  send(reader, packet);
}

/// Answers the first request with this descriptor.
std::function<void(Descriptor&)> answering(const std::function<Descriptor()>& make)
{
  return [make](Descriptor& reader)
  {
    welcome(reader);
    SlotRequest request;
    Descriptor passed;
    receive(reader, request, passed);
    const SlotAnswer answer{request.memory, request.slot};
    send(reader, answer, make());
    waitForEnd(reader);
  };
}

/// What a reader says of a host that does so; empty if it gets the frame.
std::string readingFrom(const std::function<void(Descriptor&)>& treat, double timeout = 60.0)
{
  Host host(treat);
  SlotReader reader(timeout);
  try
  {
    reader.hold(host.address);
  }
  catch (const SharedMemoryError& error)
  {
    return error.what();
  }
  return "";
}

void expectReason(const std::string& said, const std::string& reason)
{
  EXPECT_NE(said.find(reason), std::string::npos) << "'" << said << "' instead of '" << reason << "'";
}

}  // namespace

TEST(SlotServer, waitsWhileNoReaderCanBeAccepted)
{
  SlotWriter writer;
  const SlotAddress address = publish(writer);
  SlotReader reader;
  const auto holds = [&]
  {
    try
    {
      return reader.hold(address) != nullptr;
    }
    catch (const SharedMemoryError&)
    {
      return false;
    }
  };
  has_descriptors = false;
  accepts = 0;
  EXPECT_TRUE(becomes([&] { return !holds() && accepts > 0; }));  // each time after kTimeout
  accepts = 0;
  EXPECT_FALSE(holds());
  EXPECT_LT(accepts, 100);
  has_descriptors = true;
  EXPECT_TRUE(becomes(holds));
}

TEST(HostileReaders, areDisconnectedForWhatTheySayAtFirst)
{
  SlotWriter writer;
  const SlotAddress address = publish(writer);
  const std::shared_ptr<WritableSlot> kept = writer.take(kBytes);
  ASSERT_TRUE(becomes([&] { return writer.readers() == 0; }));  // those of other tests have gone
  const std::size_t descriptors = openDescriptors();
  SlotGreeting good;
  good.publisher = address.publisher;
  const auto is_refused = [&](const SlotGreeting& greeting, const Descriptor& row)
  {
    const Descriptor socket = connectTo(address.socket, 10);
    send(socket, greeting, row);
    return isClosed(socket);
  };
  EXPECT_TRUE(is_refused(good, Descriptor()));
  EXPECT_TRUE(is_refused(good, memory(kRowBytes, kRowBytes, 0)));
  EXPECT_TRUE(is_refused(good, memory(kRowBytes, kRowBytes, kFutureWrite)));
  EXPECT_TRUE(is_refused(good, memory(kRowBytes, 0, kShrink | kFutureWrite)));
  EXPECT_TRUE(is_refused(good, goodMemory(kRowBytes - 1)));
  EXPECT_TRUE(is_refused(good, goodMemory(1 << 20)));
  EXPECT_TRUE(is_refused(good, Descriptor(open("/dev/zero", O_RDWR | O_CLOEXEC))));
  EXPECT_TRUE(is_refused(good, Descriptor(open("/proc/self/exe", O_RDONLY | O_CLOEXEC))));
  if (writeProtection() == WriteProtection::kSeal) EXPECT_TRUE(is_refused(good, memory(kRowBytes, kRowBytes, kShrink)));
  SlotGreeting other = good;
  other.version += 1;
  EXPECT_TRUE(is_refused(other, goodMemory(kRowBytes)));
  other = good;
  other.publisher += 1;
  EXPECT_TRUE(is_refused(other, goodMemory(kRowBytes)));
  const Descriptor talkative = connectTo(address.socket, 10);
  const std::vector<char> much(10000, 'x');
  EXPECT_TRUE(sendPacket(talkative, much.data(), much.size(), goodMemory(kRowBytes)));
  EXPECT_TRUE(isClosed(talkative));
  EXPECT_EQ(writer.readers(), 0U);
  EXPECT_TRUE(becomes([&] { return openDescriptors() == descriptors + 1; }));  // talkative
  EXPECT_NO_THROW(publish(writer));
}

TEST(HostileReaders, thatAskForAnythingGetNothing)
{
  SlotWriter writer;
  const SlotAddress address = publish(writer);
  Guest guest(address);
  for (const std::uint64_t slot : {std::uint64_t{1024}, ~std::uint64_t{0}, std::uint64_t{1} << 32, std::uint64_t{7}})
  {
    send(guest.socket, SlotRequest{address.memory, slot});
    SlotAnswer answer;
    Descriptor passed;
    EXPECT_EQ(receive(guest.socket, answer, passed), Received::kPacket);
    EXPECT_FALSE(passed);
  }
  send(guest.socket, SlotRequest{address.memory, 0}, goodMemory(4096));  // with a descriptor
  EXPECT_TRUE(isClosed(guest.socket));
  EXPECT_TRUE(becomes([&] { return writer.readers() == 0; }));
}

TEST(HostileReaders, thatSendTwoDescriptorsAreDisconnectedAndLeaveNone)
{
  constexpr std::size_t kAttacks = 20;
  SlotWriter writer;
  const std::size_t before = openDescriptors();
  for (std::size_t attack = 0; attack < kAttacks; ++attack)
  {
    const Guest guest(publish(writer));
    SlotRequest request;
    iovec vector{&request, sizeof(request)};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(2 * sizeof(int))> control{};
    msghdr header{};
    header.msg_iov = &vector;
    header.msg_iovlen = 1;
    header.msg_control = control.data();
    header.msg_controllen = control.size();
    cmsghdr* item = CMSG_FIRSTHDR(&header);
    item->cmsg_level = SOL_SOCKET;
    item->cmsg_type = SCM_RIGHTS;
    item->cmsg_len = CMSG_LEN(2 * sizeof(int));
    const std::array<int, 2> numbers{guest.row.descriptor.get(), guest.row.descriptor.get()};
    std::memcpy(CMSG_DATA(item), numbers.data(), sizeof(numbers));
    ASSERT_EQ(sendmsg(guest.socket.get(), &header, 0), static_cast<ssize_t>(sizeof(request)));
    EXPECT_TRUE(isClosed(guest.socket));
  }
  // Half of them: the writer has memory and a socket of its own, and its thread may not yet have closed the last ones.
  EXPECT_TRUE(becomes([&] { return openDescriptors() < before + kAttacks / 2; }))
      << openDescriptors() << " after " << before;
}

TEST(HostileReaders, thatDoNotReadAnswersAreDisconnected)
{
  SlotWriter writer;
  const SlotAddress address = publish(writer);
  Guest guest(address);
  EXPECT_TRUE(becomes(
      [&]
      {
        send(guest.socket, SlotRequest{address.memory, address.slot});
        return writer.readers() == 0;
      }));
  EXPECT_NO_THROW(publish(writer));
}

TEST(HostileReaders, thatHoldAllSlotsAreDismissed)
{
  SlotWriter writer;
  const SlotAddress address = publish(writer);
  Guest guest(address);
  PatientReader reader;
  const std::shared_ptr<const HeldSlot> held = reader.hold(publish(writer));
  for (std::size_t word = 0; word < kRowWords; ++word)
    guest.words()[word] = ~std::uint64_t{0};
  for (int i = 0; i < 100; ++i)
    EXPECT_NO_THROW(publish(writer));
  EXPECT_TRUE(isClosed(guest.socket));
  EXPECT_EQ(writer.readers(), 1U);
  EXPECT_NO_THROW(reader.hold(publish(writer)));
}

TEST(HostileReaders, cannotChangeAFrame)
{
  SlotWriter writer;
  const SlotAddress address = publish(writer);
  Guest guest(address);
  send(guest.socket, SlotRequest{address.memory, address.slot});
  SlotAnswer answer;
  Descriptor passed;
  ASSERT_EQ(receive(guest.socket, answer, passed), Received::kPacket);
  ASSERT_TRUE(passed);
  EXPECT_NE(ftruncate(passed.get(), 0), 0);
  EXPECT_NE(fcntl(passed.get(), F_ADD_SEALS, F_SEAL_WRITE), 0);
  EXPECT_EQ(write(passed.get(), "x", 1), -1);
  EXPECT_EQ(mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, passed.get(), 0), MAP_FAILED);
  EXPECT_NE(fallocate(passed.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, 4096), 0);
  if (writeProtection() != WriteProtection::kSeal) return;
  const std::string anew = "/proc/self/fd/" + std::to_string(passed.get());
  const Descriptor opened(open(anew.c_str(), O_RDWR | O_CLOEXEC));
  EXPECT_EQ(mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, opened.get(), 0), MAP_FAILED);
  EXPECT_EQ(write(opened.get(), "x", 1), -1);
}

TEST(HostileReaders, areKeptFromWritingByTheDescriptorOnOlderKernels)
{
  const MemoryFile file = makeMemoryFile("old", 4096, WriteProtection::kReadOnlyDescriptor);
  EXPECT_EQ(write(file.descriptor.get(), "x", 1), -1);
  EXPECT_EQ(mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, file.descriptor.get(), 0), MAP_FAILED);
  EXPECT_NE(fcntl(file.descriptor.get(), F_GET_SEALS) & F_SEAL_SHRINK, 0);
}

TEST(HostilePublishers, areRefusedForTheMemoryThatTheyGive)
{
  const std::size_t descriptors = openDescriptors();
  const std::size_t whole = kSlotHeaderBytes + 12288;
  const auto giving = [](std::function<Descriptor()> make) { return readingFrom(answering(make)); };
  expectReason(giving([&] { return memory(whole, whole, kFutureWrite); }), "it can be truncated");
  expectReason(giving([&] { return memory(whole, 0, kShrink | kFutureWrite); }), "it has holes");
  expectReason(giving([&] { return memory(whole, 8192, kShrink | kFutureWrite); }), "it has holes");
  expectReason(giving([&] { return memory(std::size_t{1} << 40, 0, kShrink | kFutureWrite); }), "1099511627776 bytes");
  expectReason(giving([&] { return goodMemory(4095); }), "4095 bytes");
  expectReason(giving([&] { return goodMemory(0); }), "0 bytes");
  expectReason(giving([&] { return goodMemory(kSlotHeaderBytes); }), "room for 0");
  expectReason(giving([&] { return goodMemory(kSlotHeaderBytes + kBytes - 1); }), "room for 9999");
  expectReason(giving([&] { return goodMemory(whole); }), "overwritten");  // it is good, with another generation
  expectReason(giving([] { return Descriptor(); }), "overwritten");
  expectReason(giving([] { return Descriptor(open("/dev/zero", O_RDWR | O_CLOEXEC)); }), "is refused");
  expectReason(giving([] { return Descriptor(open("/proc/self/exe", O_RDONLY | O_CLOEXEC)); }), "is refused");
  expectReason(giving([] { return Descriptor(open("/proc", O_RDONLY | O_CLOEXEC)); }), "is refused");
  if (writeProtection() == WriteProtection::kSeal)
    expectReason(giving([&] { return memory(whole, whole, kShrink); }), "its pages can be taken away");
  EXPECT_EQ(openDescriptors(), descriptors);
}

TEST(HostilePublishers, areRefusedForWhatTheySay)
{
  const std::size_t descriptors = openDescriptors();
  expectReason(readingFrom([](Descriptor&) {}), "has ended");
  expectReason(readingFrom([](Descriptor& reader) { waitForEnd(reader); }, 1.0), "does not answer");
  expectReason(readingFrom(
                   [](Descriptor& reader)
                   {
                     sendPacket(reader, "hello", 5, Descriptor());
                     waitForEnd(reader);
                   }),
               "an answer that is none");
  const auto greeting = [](const SlotWelcome& packet, const std::function<Descriptor()>& make)
  {
    return readingFrom(
        [=](Descriptor& reader)
        {
          send(reader, packet, make());
          waitForEnd(reader);
        });
  };
  const auto none = [] { return Descriptor(); };
  expectReason(greeting(SlotWelcome(), none), "an answer that is none");  // of publisher 0
  SlotWelcome packet;
  packet.publisher = 42;
  packet.version += 1;
  expectReason(greeting(packet, none), "an answer that is none");
  packet = SlotWelcome();
  packet.publisher = 42;
  packet.max_slots = 1 << 30;
  expectReason(greeting(packet, none), "an answer that is none");
  packet.max_slots = kMaxSlots;
  expectReason(greeting(packet, [] { return goodMemory(4096); }), "an answer that is none");
  const auto other_slot = [](Descriptor& reader)
  {
    welcome(reader);
    send(reader, SlotAnswer{1, 5}, goodMemory(65536));
    waitForEnd(reader);
  };
  expectReason(readingFrom(other_slot), "an answer that is none");
  const auto silent = [](Descriptor& reader)
  {
    welcome(reader);
    waitForEnd(reader);
  };
  expectReason(readingFrom(silent, 1.0), "does not answer");
  EXPECT_EQ(openDescriptors(), descriptors);
}

TEST(HostilePublishers, cannotTakePagesAwayFromUnderAReader)
{
  const std::size_t whole = kSlotHeaderBytes + 12288;
  const Descriptor kept = goodMemory(whole);
  // Generation 2, which the address names, written before the seal would keep it out.
  Descriptor written(memfd_create("foreign", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  ASSERT_EQ(fallocate(written.get(), 0, 0, static_cast<off_t>(whole)), 0);
  const std::array<std::uint64_t, 3> header{2, 1, 100};
  ASSERT_EQ(pwrite(written.get(), header.data(), sizeof(header), 0), static_cast<ssize_t>(sizeof(header)));
  ASSERT_EQ(fcntl(written.get(), F_ADD_SEALS, kShrink | kFutureWrite), 0);
  Host host(answering([&] { return Descriptor(fcntl(written.get(), F_DUPFD_CLOEXEC, 0)); }));
  {
    PatientReader reader;
    const std::shared_ptr<const HeldSlot> held = reader.hold(host.address);
    EXPECT_NE(ftruncate(written.get(), 0), 0);
    EXPECT_NE(fallocate(written.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(whole)), 0);
    for (std::size_t i = 0; i < held->bytes(); ++i)
      EXPECT_EQ(held->data()[i], 0);
  }
}
