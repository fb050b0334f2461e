#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <fstream>
#include <functional>
#include <new>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>

#include "ros/shared_memory/slot_address.hpp"
#include "ros/shared_memory/slot_reader.hpp"

/// Processes for tests: forked without exec, so that there can be a thousand of them in some seconds.
namespace processes
{

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kDeadline{60};

/// Whether this became true before the deadline. It is looked at once in a period.
inline bool becomes(const std::function<bool()>& condition, std::chrono::seconds deadline = kDeadline,
                    std::chrono::microseconds period = std::chrono::microseconds(100))
{
  const Clock::time_point end = Clock::now() + deadline;
  while (!condition())
  {
    if (Clock::now() > end) return false;
    std::this_thread::sleep_for(period);
  }
  return true;
}

/// A reader for which a publisher's process may be long without a core.
struct PatientReader : robot_vision::SlotReader
{
  PatientReader() : SlotReader(static_cast<double>(kDeadline.count())) {}
};

/// A forked process that runs a function, whose result is its exit code, and is killed at the end of this and at that
/// of the thread that has made it: what kills a test leaves none behind.
class Child
{
public:
  explicit Child(const std::function<int()>& work) : process_(fork())
  {
    if (process_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    int code = 98;
    try
    {
      code = work();
    }
    catch (const std::exception& error)
    {
      std::fprintf(stderr, "child: %s\n", error.what());
    }
    _exit(code);
  }
  ~Child() { kill(); }
  Child(Child&& other) noexcept : process_(std::exchange(other.process_, -1)) {}
  Child& operator=(Child&& other) noexcept
  {
    std::swap(process_, other.process_);
    return *this;
  }

  void signal(int number) const { ::kill(process_, number); }
  /// Kills it; returns what code it ended with, if it had ended before.
  std::optional<int> kill()
  {
    if (process_ <= 0) return std::nullopt;
    signal(SIGKILL);
    int status = 0;
    waitpid(std::exchange(process_, -1), &status, 0);
    return WIFEXITED(status) ? std::optional<int>(WEXITSTATUS(status)) : std::nullopt;
  }
  /// The code with which it ends; 128 and more for a signal, -1 if it does not end in time.
  int wait()
  {
    int status = 0;
    if (!becomes([&] { return waitpid(process_, &status, WNOHANG) == process_; })) return -1;
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

private:
  pid_t process_;
};

/// An object in memory that forked processes share.
template <class Object>
class Shared
{
public:
  Shared()
    : object_(new (mmap(nullptr, sizeof(Object), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) Object())
  {
  }
  ~Shared() { munmap(object_, sizeof(Object)); }
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;

  Object* operator->() const { return object_; }
  Object& operator*() const { return *object_; }

private:
  Object* object_;
};

/// Where a publisher leaves the address of its newest frame, in place of a message; and what readers count.
class Board
{
public:
  void post(const robot_vision::SlotAddress& address)
  {
    Entry entry;
    std::snprintf(entry.socket, sizeof(entry.socket), "%s", address.socket.c_str());
    entry.publisher = address.publisher;
    entry.memory = address.memory;
    entry.generation = address.generation;
    entry.bytes = address.bytes;
    entry.slot = address.slot;
    std::array<std::uint64_t, sizeof(Entry) / 8> words;
    std::memcpy(words.data(), &entry, sizeof(entry));
    const std::uint64_t number = number_.load();
    number_.store(number | 1);
    for (std::size_t i = 0; i < words.size(); ++i)
      words_[i].store(words[i]);
    number_.store((number | 1) + 1);
  }

  /// The newest, or none, if it is just being written.
  std::optional<robot_vision::SlotAddress> newest() const
  {
    std::array<std::uint64_t, sizeof(Entry) / 8> words;
    const std::uint64_t number = number_.load();
    for (std::size_t i = 0; i < words.size(); ++i)
      words[i] = words_[i].load();
    if (number == 0 || (number & 1) != 0 || number_.load() != number) return std::nullopt;
    Entry entry;
    std::memcpy(&entry, words.data(), sizeof(entry));
    robot_vision::SlotAddress address;
    address.boot_id = robot_vision::bootId();
    address.socket = entry.socket;
    address.publisher = entry.publisher;
    address.memory = entry.memory;
    address.generation = entry.generation;
    address.bytes = entry.bytes;
    address.slot = entry.slot;
    return address;
  }

  std::atomic<std::uint64_t> held{0};  // frames that were held and found whole
  std::atomic<std::uint64_t> torn{0};

private:
  struct Entry
  {
    char socket[64] = "";
    std::uint64_t publisher = 0;
    std::uint64_t memory = 0;
    std::uint64_t generation = 0;
    std::uint64_t bytes = 0;
    std::uint64_t slot = 0;
  };
  std::atomic<std::uint64_t> number_{0};  // odd while it is written
  std::array<std::atomic<std::uint64_t>, sizeof(Entry) / 8> words_{};
};

/// Asks for each, as there may be none left to look into /proc.
inline std::size_t openDescriptors()
{
  std::size_t count = 0;
  for (int number = 0; number < 1024; ++number)
    count += fcntl(number, F_GETFD) != -1;
  return count;
}

/// The mappings of memory for images in this process.
inline std::size_t mappedMemory()
{
  std::size_t count = 0;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    count += line.find("memfd:robot_vision") != std::string::npos;
  return count;
}

/// Pixels by which a frame is recognized, and whether it is whole: a sequence of numbers that begins anywhere.
inline void fillFrame(std::uint8_t* pixels, std::size_t bytes, std::uint64_t number)
{
  auto* words = reinterpret_cast<std::uint64_t*>(pixels);
  for (std::size_t i = 0; i < bytes / 8; ++i)
    words[i] = (number + i) * 0x9e3779b97f4a7c15U;
}

inline bool isWhole(const std::uint8_t* pixels, std::size_t bytes)
{
  const auto* words = reinterpret_cast<const std::uint64_t*>(pixels);
  for (std::size_t i = 1; i < bytes / 8; ++i)
    if (words[i] - words[i - 1] != 0x9e3779b97f4a7c15U) return false;
  return true;
}

}  // namespace processes
