#include "slot_table.hpp"

#include <algorithm>
#include <utility>

#include "lease_protocol.hpp"

namespace robot_vision
{
namespace
{

bool holds(const Mapping& row, std::uint32_t slot)
{
  const auto* words = reinterpret_cast<const SharedWord*>(row.data());
  return (words[slot / 64].load(std::memory_order_acquire) >> (slot % 64) & 1) != 0;
}

}  // namespace

std::optional<std::uint32_t> SlotTable::claim()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const bool any : {false, true})  // else who sets all bits of its row would leave none to others
    for (std::uint32_t slot = 0; slot < kMaxSlots; ++slot)
    {
      if (claimed_[slot] || (!any && isHeld(slot))) continue;
      claimed_.set(slot);
      return slot;
    }
  return std::nullopt;
}

void SlotTable::disclaim(std::uint32_t slot)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  claimed_.reset(slot);
}

std::uint64_t SlotTable::place(std::uint32_t slot, std::shared_ptr<const MemoryFile> memory)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  placed_[slot] = {++memories_, std::move(memory)};
  return memories_;
}

void SlotTable::remove(std::uint32_t slot)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  placed_.erase(slot);
}

std::shared_ptr<const MemoryFile> SlotTable::memory(std::uint64_t slot, std::uint64_t number) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = slot < kMaxSlots ? placed_.find(static_cast<std::uint32_t>(slot)) : placed_.end();
  if (found == placed_.end() || found->second.number != number) return nullptr;
  return found->second.memory;
}

bool SlotTable::take(std::uint32_t slot, SharedWord& generation, std::uint64_t published) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return lease::take(generation, published, [&] { return isHeld(slot); });
}

bool SlotTable::isHeld(std::uint32_t slot) const
{
  return std::any_of(rows_.begin(), rows_.end(), [slot](const auto& row) { return holds(row.second, slot); });
}

std::uint64_t SlotTable::nextGeneration()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  generations_ += 2;  // odd ones are busy
  return generations_;
}

void SlotTable::addRow(std::uint64_t reader, Mapping row)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  rows_[reader] = std::move(row);
}

void SlotTable::removeRow(std::uint64_t reader)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  rows_.erase(reader);
}

std::size_t SlotTable::rows() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return rows_.size();
}

std::vector<std::uint64_t> SlotTable::greedyReaders(const std::vector<std::uint32_t>& slots, std::size_t quota) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::uint64_t> greedy;
  for (const auto& row : rows_)
  {
    const auto held = std::count_if(slots.begin(), slots.end(), [&](auto slot) { return holds(row.second, slot); });
    if (static_cast<std::size_t>(held) > quota) greedy.push_back(row.first);
  }
  return greedy;
}

}  // namespace robot_vision
