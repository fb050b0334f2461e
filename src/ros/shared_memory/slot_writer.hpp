#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "slot_address.hpp"

namespace robot_vision
{

class SlotPool;
class SlotServer;
struct PooledSlot;

/// Memory for the pixels of one frame, which other processes of this user can read once it is published, and cannot
/// write. While it exists it is held by this process: the pixels stay as they are.
class WritableSlot
{
public:
  WritableSlot(std::shared_ptr<SlotPool> pool, PooledSlot& slot, std::size_t bytes);
  ~WritableSlot();
  WritableSlot(const WritableSlot&) = delete;
  WritableSlot& operator=(const WritableSlot&) = delete;

  /// The pixels, at a multiple of 4096 bytes. Their content is undefined. They must not be written after publish().
  std::uint8_t* data() { return data_; }
  const std::uint8_t* data() const { return data_; }
  std::size_t bytes() const { return bytes_; }

  /// Makes the pixels readable for others and tells where they are. Called again it tells the same.
  SlotAddress publish();

private:
  std::shared_ptr<SlotPool> pool_;
  PooledSlot& slot_;
  std::uint8_t* data_;
  std::size_t bytes_;
};

/// The slot whose pixels these are, if it is held by this process: so that a message that stands in one is recognized.
/// Null for other memory.
std::shared_ptr<WritableSlot> findSlot(const std::uint8_t* pixels);

/// The slots of one topic, in the memory that this process shares. Thread-safe. There may be any number of writers in
/// a process; they share one socket and one thread. What is left of a writer after its end are the slots in use.
class SlotWriter
{
public:
  struct Limits
  {
    std::size_t max_slots = 32;
    std::size_t max_bytes = std::size_t{1} << 29;  // of all slots together
    /// Slots that are made before the first is used again: messages of so many frames less one can be on their way to
    /// a reader that has not held them yet.
    std::size_t min_slots = 4;
  };
  struct Counts
  {
    std::size_t slots = 0;      // that have memory
    std::size_t bytes = 0;      // of this memory
    std::uint64_t dropped = 0;  // calls of take() that found nothing
    std::string reason;         // why the last of these did; empty if there was none
  };

  SlotWriter() : SlotWriter(Limits()) {}
  explicit SlotWriter(const Limits& limits);
  /// With a server of its own instead of the one that all writers of the process have in common.
  SlotWriter(const Limits& limits, std::shared_ptr<SlotServer> server);
  ~SlotWriter();
  SlotWriter(const SlotWriter&) = delete;
  SlotWriter& operator=(const SlotWriter&) = delete;

  /// Takes memory for that many bytes that nobody reads, in this process or in others. Null if the limits are reached,
  /// because readers hold what there is, or if the system has no memory or descriptors: the frame is to be dropped.
  /// In a forked child it is always null: the slots are the parent's.
  std::shared_ptr<WritableSlot> take(std::size_t bytes);

  /// Gives back what memory is not in use, and what is in use as soon as it is not, unless take() needs it by then.
  void rest();

  Counts counts() const;
  /// Processes that are connected to this one's socket, whichever of its topics they read.
  std::size_t readers() const;

private:
  std::shared_ptr<SlotPool> pool_;
};

}  // namespace robot_vision
