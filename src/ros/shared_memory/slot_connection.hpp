#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "memory_file.hpp"
#include "slot_address.hpp"
#include "slot_packets.hpp"

namespace robot_vision
{

/// The memory of a publisher's slot, as a reader has it. Nothing in there is trusted but that it stays mapped.
class MappedSlot
{
public:
  MappedSlot(std::uint32_t bit, std::uint64_t memory, Mapping mapping);

  const SharedWord& generation() const { return header().generation; }
  const std::uint8_t* pixels() const { return mapping_.data() + kSlotHeaderBytes; }
  std::size_t capacity() const { return mapping_.bytes() - kSlotHeaderBytes; }
  bool isGone() const;

  const std::uint32_t bit;
  const std::uint64_t memory;
  const std::uint64_t pool;   // as the publisher said at first
  const std::uint64_t quota;  // of held slots of that pool

private:
  const SlotHeader& header() const { return *reinterpret_cast<const SlotHeader*>(mapping_.data()); }

  Mapping mapping_;
};

/// A reading process' connection to a publishing one: the row in which it tells what it holds, and the slots that it
/// has mapped. Thread-safe.
class SlotConnection
{
public:
  /// Waits for each answer at most `timeout` (s). Throws SharedMemoryError.
  SlotConnection(const SlotAddress& address, double timeout);
  ~SlotConnection();
  SlotConnection(const SlotConnection&) = delete;
  SlotConnection& operator=(const SlotConnection&) = delete;

  /// The slot with the memory of that address, which is asked for if it is new. Throws SharedMemoryError.
  std::shared_ptr<MappedSlot> slot(const SlotAddress& address);
  /// Holds that frame in this slot. Throws SharedMemoryError.
  void hold(MappedSlot& slot, std::uint64_t generation);
  void release(MappedSlot& slot);

  bool isOfThisProcess() const { return forks_ == forkCount(); }
  std::uint64_t publisher() const { return publisher_; }
  /// Whether nothing more can be asked: the publisher has ended, or has not answered as it must.
  bool hasEnded() const;
  /// Memory that the publisher has left stays with those that hold it only.
  void forgetGone();

private:
  struct Holders
  {
    std::size_t count = 0;
    std::uint64_t pool = 0;
  };

  std::shared_ptr<MappedSlot> mapped(const SlotAddress& address);
  std::shared_ptr<MappedSlot> request(const SlotAddress& address);
  SharedWord& rowWord(std::uint32_t bit) const;

  const unsigned forks_ = forkCount();
  const std::uint64_t publisher_;
  Descriptor socket_;
  Mapping row_;
  std::atomic<bool> failed_{false};  // an answer may come late, and be taken for another's
  std::mutex requests_;              // one at a time
  std::mutex mutex_;                 // guards what is below and the row
  std::map<std::uint32_t, std::shared_ptr<MappedSlot>> slots_;
  std::vector<Holders> holders_;               // in this process, by the bit of the slot
  std::map<std::uint64_t, std::size_t> held_;  // how many slots, by pool
};

}  // namespace robot_vision
