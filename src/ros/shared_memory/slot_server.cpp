#include "slot_server.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <random>
#include <system_error>
#include <utility>

#include "seqpacket.hpp"
#include "shared_memory_error.hpp"
#include "signals_blocked.hpp"
#include "slot_names.hpp"

namespace robot_vision
{
namespace
{

using Clock = std::chrono::steady_clock;
constexpr int kPollPeriod = 1000;              // ms, while readers have yet to greet or to be accepted
constexpr std::size_t kMaxRowBytes = 1 << 16;  // a page, of any machine

std::uint64_t randomNumber()
{
  std::random_device device;
  return std::uint64_t{device()} << 32 | device();
}

Descriptor openSpare()
{
  return Descriptor(open("/dev/null", O_RDONLY | O_CLOEXEC));
}

struct SharedServer
{
  std::mutex mutex;
  std::weak_ptr<SlotServer> server;
};

}  // namespace

struct SlotServer::Reader
{
  std::uint64_t number = 0;
  Descriptor socket;
  Clock::time_point accepted;
  bool greeted = false;
};

std::shared_ptr<SlotServer> SlotServer::ofProcess()
{
  static PerProcess<SharedServer> of_processes;
  SharedServer& shared = of_processes.get();
  const std::lock_guard<std::mutex> lock(shared.mutex);
  std::shared_ptr<SlotServer> server = shared.server.lock();
  if (!server) shared.server = server = std::make_shared<SlotServer>();
  return server;
}

SlotServer::SlotServer()
  : name_(slotSocketName(randomNumber(), randomNumber())),
    publisher_(randomNumber()),
    listening_(listenAt(name_)),
    wakeup_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
    spare_(openSpare())
{
  if (!wakeup_ || !spare_)
    throw SharedMemoryError(SharedMemoryFault::kNoDescriptors,
                            "no descriptors for images in shared memory: " + std::generic_category().message(errno));
  fcntl(listening_.get(), F_SETFL, O_NONBLOCK);
  const SignalsBlocked blocked;
  try
  {
    thread_ = std::make_unique<std::thread>([this] { run(); });
  }
  catch (const std::system_error& error)
  {
    throw SharedMemoryError(SharedMemoryFault::kNoDescriptors,
                            std::string("no thread for images in shared memory: ") + error.what());
  }
}

SlotServer::~SlotServer()
{
  if (forks_ != forkCount())
  {
    thread_.release();  // it runs in the parent only, and a std::thread cannot be told so
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ending_ = true;
  }
  wake();
  thread_->join();
}

void SlotServer::dismiss(std::uint64_t reader)
{
  table_.removeRow(reader);
  const std::lock_guard<std::mutex> lock(mutex_);
  dismissed_.push_back(reader);
  wake();
}

void SlotServer::wake() const
{
  const std::uint64_t one = 1;
  const ssize_t written = write(wakeup_.get(), &one, sizeof(one));
  static_cast<void>(written);  // it fails only when there are many already
}

void SlotServer::run()
{
  Readers readers;
  std::vector<pollfd> polled;
  bool can_accept = true;
  while (!isEnding(readers))
  {
    polled = {{wakeup_.get(), POLLIN, 0}, {can_accept ? listening_.get() : -1, POLLIN, 0}};
    bool all_greeted = true;
    for (const auto& [number, reader] : readers)
    {
      polled.push_back({reader.socket.get(), POLLIN, 0});
      all_greeted &= reader.greeted;
    }
    poll(polled.data(), polled.size(), all_greeted && can_accept ? -1 : kPollPeriod);
    auto entry = readers.begin();
    for (std::size_t i = 2; i < polled.size(); ++i)
    {
      Reader& reader = (entry++)->second;
      if (isLate(reader) || (polled[i].revents != 0 && !answer(reader))) leave(readers, reader.number);
    }
    can_accept = polled[1].revents == 0 || accept(readers);
  }
}

/// Does what other threads ask for.
bool SlotServer::isEnding(Readers& readers)
{
  std::uint64_t count;
  const ssize_t got = read(wakeup_.get(), &count, sizeof(count));
  static_cast<void>(got);  // nothing, if it was not this that woke the thread
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const std::uint64_t number : dismissed_)
    leave(readers, number);
  dismissed_.clear();
  return ending_;
}

bool SlotServer::isLate(const Reader& reader)
{
  const std::chrono::duration<double> silent = Clock::now() - reader.accepted;
  return !reader.greeted && silent.count() > kGreetingTimeout;
}

void SlotServer::leave(Readers& readers, std::uint64_t number)
{
  table_.removeRow(number);
  readers.erase(number);
}

/// False if those who wait could not be accepted, of whom poll() would tell at once again.
bool SlotServer::accept(Readers& readers)
{
  Descriptor socket(accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!socket && (errno == EMFILE || errno == ENFILE))
  {
    // The reader is told at once.
    spare_.reset();
    socket = Descriptor(accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    const bool is_told = static_cast<bool>(socket);
    socket.reset();
    spare_ = openSpare();
    return is_told;
  }
  if (!socket) return errno != ENOBUFS && errno != ENOMEM;
  if (readers.size() >= kMaxReaders || !isOfThisUser(socket)) return true;
  const std::uint64_t number = ++accepted_;
  readers[number] = {number, std::move(socket), Clock::now(), false};
  return true;
}

/// Reads what a reader has sent and answers. False if it is to be disconnected.
bool SlotServer::answer(Reader& reader)
{
  if (!reader.greeted) return greet(reader);
  SlotRequest request;
  Descriptor passed;
  const Received received = receive(reader.socket, request, passed, MSG_DONTWAIT);
  if (received == Received::kNothing) return true;
  if (received != Received::kPacket || passed) return false;
  const std::shared_ptr<const MemoryFile> memory = table_.memory(request.slot, request.memory);
  SlotAnswer answered;
  answered.slot = request.slot;
  answered.memory = request.memory;
  return memory ? send(reader.socket, answered, memory->descriptor) : send(reader.socket, answered);
}

bool SlotServer::greet(Reader& reader)
{
  SlotGreeting greeting;
  Descriptor row;
  const Received received = receive(reader.socket, greeting, row, MSG_DONTWAIT);
  if (received == Received::kNothing) return true;
  SlotGreeting expected;
  expected.publisher = publisher_;
  const bool fits = greeting.magic == expected.magic && greeting.version == expected.version &&
                    greeting.row_bytes == expected.row_bytes && greeting.publisher == expected.publisher;
  if (received != Received::kPacket || !row || !fits) return false;
  try
  {
    table_.addRow(reader.number, mapForeignMemory(row, kRowBytes, kMaxRowBytes));
  }
  catch (const SharedMemoryError&)
  {
    return false;
  }
  SlotWelcome welcome;
  welcome.publisher = publisher_;
  reader.greeted = send(reader.socket, welcome);
  return reader.greeted;
}

}  // namespace robot_vision
