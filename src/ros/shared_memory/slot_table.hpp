#pragma once

#include <bitset>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "memory_file.hpp"
#include "slot_packets.hpp"

namespace robot_vision
{

/// The slots of this process and what its readers say of them: the memory that is in each slot, and the rows of bits in
/// which each reader tells what it holds. Thread-safe.
class SlotTable
{
public:
  /// A slot that nobody else has, or none if there are kMaxSlots. If possible it is one that no reader holds for memory
  /// that was there before, as that would count as one more of the new owner's.
  std::optional<std::uint32_t> claim();
  /// The slot is free for others again. No memory may be in it.
  void disclaim(std::uint32_t slot);

  /// Puts memory into a slot, for readers that ask; returns its number.
  std::uint64_t place(std::uint32_t slot, std::shared_ptr<const MemoryFile> memory);
  void remove(std::uint32_t slot);
  /// Null if that memory is not there, or no longer.
  std::shared_ptr<const MemoryFile> memory(std::uint64_t slot, std::uint64_t number) const;

  /// Takes a slot for writing, unless a reader holds it.
  bool take(std::uint32_t slot, SharedWord& generation, std::uint64_t published) const;
  /// A generation that no slot of this process has had.
  std::uint64_t nextGeneration();

  void addRow(std::uint64_t reader, Mapping row);
  /// What the reader held is held no longer.
  void removeRow(std::uint64_t reader);
  std::size_t rows() const;
  /// The readers that hold more than `quota` of these slots.
  std::vector<std::uint64_t> greedyReaders(const std::vector<std::uint32_t>& slots, std::size_t quota) const;

private:
  bool isHeld(std::uint32_t slot) const;

  struct Placed
  {
    std::uint64_t number = 0;
    std::shared_ptr<const MemoryFile> memory;
  };

  mutable std::mutex mutex_;  // guards all below
  std::bitset<kMaxSlots> claimed_;
  std::map<std::uint32_t, Placed> placed_;
  std::map<std::uint64_t, Mapping> rows_;
  std::uint64_t memories_ = 0;
  std::uint64_t generations_ = 0;
};

}  // namespace robot_vision
