#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "slot_packets.hpp"
#include "slot_server.hpp"
#include "slot_writer.hpp"

namespace robot_vision
{

/// A slot with its memory.
struct PooledSlot
{
  std::uint32_t bit = 0;     // in the rows of readers
  std::uint64_t memory = 0;  // its number
  std::shared_ptr<const MemoryFile> file;
  std::size_t capacity = 0;      // bytes of pixels
  std::uint64_t generation = 0;  // as readers see it: busy from take() to publish()
  std::uint64_t taken = 0;       // the number of the take() that took it last
  bool in_use = false;           // by a WritableSlot

  SlotHeader& header() const { return *reinterpret_cast<SlotHeader*>(file->mapping.data()); }
  std::uint8_t* pixels() const { return file->mapping.data() + kSlotHeaderBytes; }
};

/// The slots of a SlotWriter, and of the WritableSlots that outlive it. Which one is taken: of those that nobody holds
/// the one that was published last, so that few are in use and in the processor's caches, except for the newest, whose
/// messages may be on their way.
class SlotPool : public std::enable_shared_from_this<SlotPool>
{
public:
  SlotPool(const SlotWriter::Limits& limits, std::shared_ptr<SlotServer> server);
  ~SlotPool();
  SlotPool(const SlotPool&) = delete;
  SlotPool& operator=(const SlotPool&) = delete;

  std::shared_ptr<WritableSlot> take(std::size_t bytes);
  SlotAddress publish(PooledSlot& slot, std::size_t bytes);
  void giveBack(PooledSlot& slot);
  /// Frees what is free, now and when it is given back, until the next take().
  void rest();

  SlotWriter::Counts counts() const;
  std::size_t readers() const;

  static constexpr std::uint64_t kMaxIdleTakes = 256;  // after so many that it was not needed for, memory is freed

private:
  using Slots = std::list<PooledSlot>;

  bool isOfThisProcess() const { return forks_ == forkCount(); }
  PooledSlot* takeFor(std::size_t bytes);
  PooledSlot* takeFree(std::size_t bytes, std::size_t min_newer);
  PooledSlot* make(std::size_t bytes);
  bool mayBeTaken(const PooledSlot& slot, std::size_t bytes, std::size_t min_newer) const;
  bool takeFromReaders(PooledSlot& slot);
  void discardUnneeded(std::size_t bytes);
  Slots::iterator discard(Slots::iterator slot);
  bool dismissGreedyReaders();
  std::size_t quota(std::size_t total) const;

  const SlotWriter::Limits limits_;
  const unsigned forks_ = forkCount();
  mutable std::mutex mutex_;            // guards all below
  std::shared_ptr<SlotServer> server_;  // null until it is needed
  std::uint64_t number_ = 0;            // of this pool, for readers
  Slots slots_;
  std::size_t bytes_ = 0;  // of all memory
  std::uint64_t takes_ = 0;
  bool rests_ = false;
  std::uint64_t dropped_ = 0;
  std::string reason_;
};

}  // namespace robot_vision
