#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "fork_count.hpp"
#include "slot_table.hpp"

namespace robot_vision
{

/// Where readers come to this process for its slots: a socket with a random name, and a thread that answers there. What
/// a reader sends is checked, and whoever sends anything else is disconnected; nobody is waited for.
class SlotServer
{
public:
  /// Throws SharedMemoryError if there are no descriptors or no threads left.
  SlotServer();
  ~SlotServer();
  SlotServer(const SlotServer&) = delete;
  SlotServer& operator=(const SlotServer&) = delete;

  /// The server of this process, which all have in common. Throws as the constructor does.
  static std::shared_ptr<SlotServer> ofProcess();

  const std::string& socket() const { return name_; }
  std::uint64_t publisher() const { return publisher_; }
  SlotTable& table() { return table_; }

  /// Forgets what this reader holds and disconnects it.
  void dismiss(std::uint64_t reader);

  static constexpr std::size_t kMaxReaders = 512;
  static constexpr double kGreetingTimeout = 5.0;  // s; who says nothing is disconnected

private:
  struct Reader;
  using Readers = std::map<std::uint64_t, Reader>;

  void run();
  bool isEnding(Readers& readers);
  static bool isLate(const Reader& reader);
  void leave(Readers& readers, std::uint64_t number);
  bool accept(Readers& readers);
  bool answer(Reader& reader);
  bool greet(Reader& reader);
  void wake() const;

  std::string name_;
  std::uint64_t publisher_ = 0;
  SlotTable table_;
  Descriptor listening_;
  Descriptor wakeup_;
  Descriptor spare_;  // given up for a moment to refuse a reader when there are no others
  std::uint64_t accepted_ = 0;
  std::mutex mutex_;  // guards those below
  std::vector<std::uint64_t> dismissed_;
  bool ending_ = false;
  std::unique_ptr<std::thread> thread_;
  unsigned forks_ = forkCount();
};

}  // namespace robot_vision
