#include "slot_pool.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "lease_protocol.hpp"
#include "shared_memory_error.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kPage = 4096;       // bytes
constexpr std::size_t kMinSlack = 65536;  // bytes that a slot may have too many, whatever its size

std::size_t capacityFor(std::size_t bytes)
{
  return (bytes + kPage - 1) / kPage * kPage;
}

bool fits(const PooledSlot& slot, std::size_t bytes)
{
  return slot.capacity >= bytes && slot.capacity - bytes <= bytes / 4 + kMinSlack;
}

bool isPublished(const PooledSlot& slot)
{
  return (slot.generation & lease::kBusy) == 0;
}

}  // namespace

SlotPool::SlotPool(const SlotWriter::Limits& limits, std::shared_ptr<SlotServer> server)
  : limits_(limits), server_(std::move(server))
{
}

SlotPool::~SlotPool()
{
  if (isOfThisProcess()) rest();
}

/// How many slots of so many bytes one reader may hold.
std::size_t SlotPool::quota(std::size_t total) const
{
  return std::max<std::size_t>(1, std::min(limits_.max_slots, limits_.max_bytes / total) / 2);
}

std::shared_ptr<WritableSlot> SlotPool::take(std::size_t bytes)
{
  if (!isOfThisProcess()) return nullptr;
  const std::lock_guard<std::mutex> lock(mutex_);
  ++takes_;
  rests_ = false;
  try
  {
    if (!server_) server_ = SlotServer::ofProcess();
    if (number_ == 0) number_ = server_->table().nextGeneration();
    if (PooledSlot* slot = takeFor(bytes))
    {
      auto writable = std::make_shared<WritableSlot>(shared_from_this(), *slot, bytes);
      slot->in_use = true;
      slot->taken = takes_;
      return writable;
    }
    reason_ = "all " + std::to_string(slots_.size()) + " slots of " + std::to_string(bytes_) + " bytes are held";
  }
  catch (const SharedMemoryError& error)
  {
    reason_ = error.what();
  }
  ++dropped_;
  return nullptr;
}

PooledSlot* SlotPool::takeFor(std::size_t bytes)
{
  discardUnneeded(bytes);
  if (PooledSlot* slot = takeFree(bytes, std::max<std::size_t>(limits_.min_slots, 1) - 1)) return slot;
  try
  {
    if (PooledSlot* slot = make(bytes)) return slot;
  }
  catch (const SharedMemoryError&)
  {
    if (PooledSlot* slot = takeFree(bytes, 0)) return slot;
    throw;
  }
  if (PooledSlot* slot = takeFree(bytes, 0)) return slot;
  return dismissGreedyReaders() ? takeFree(bytes, 0) : nullptr;
}

/// Takes a slot that nobody holds and after which at least min_newer others were published. One that was taken and not
/// published then comes first. If all are new, it is the oldest.
PooledSlot* SlotPool::takeFree(std::size_t bytes, std::size_t min_newer)
{
  std::vector<PooledSlot*> free;
  for (PooledSlot& slot : slots_)
    if (mayBeTaken(slot, bytes, min_newer)) free.push_back(&slot);
  const auto before = [min_newer](const PooledSlot* a, const PooledSlot* b)
  {
    if (isPublished(*a) != isPublished(*b)) return isPublished(*b);
    return min_newer > 0 ? a->generation > b->generation : a->generation < b->generation;
  };
  std::sort(free.begin(), free.end(), before);
  const auto taken = std::find_if(free.begin(), free.end(), [this](auto* slot) { return takeFromReaders(*slot); });
  return taken == free.end() ? nullptr : *taken;
}

bool SlotPool::mayBeTaken(const PooledSlot& slot, std::size_t bytes, std::size_t min_newer) const
{
  if (slot.in_use || !fits(slot, bytes)) return false;
  if (!isPublished(slot)) return true;
  const auto is_newer = [&](const PooledSlot& other)
  { return isPublished(other) && other.generation > slot.generation; };
  return static_cast<std::size_t>(std::count_if(slots_.begin(), slots_.end(), is_newer)) >= min_newer;
}

/// Null if the limits are reached.
PooledSlot* SlotPool::make(std::size_t bytes)
{
  const std::size_t total = kSlotHeaderBytes + capacityFor(bytes);
  if (bytes > kMaxMemoryFile - kSlotHeaderBytes - kPage || total > limits_.max_bytes)
    throw SharedMemoryError(SharedMemoryFault::kRefused,
                            "a frame of " + std::to_string(bytes) + " bytes is beyond the limit of shared memory");
  if (slots_.size() >= limits_.max_slots || bytes_ + total > limits_.max_bytes) return nullptr;
  PooledSlot made;
  made.file = std::make_shared<MemoryFile>(makeMemoryFile("robot_vision slot", total));
  const std::optional<std::uint32_t> bit = server_->table().claim();
  if (!bit) return nullptr;
  made.bit = *bit;
  made.capacity = capacityFor(bytes);
  made.generation = lease::kBusy;
  made.header().generation.store(made.generation);
  made.header().pool.store(number_);
  made.header().quota.store(quota(total));
  made.memory = server_->table().place(made.bit, made.file);
  slots_.push_back(std::move(made));
  bytes_ += total;
  return &slots_.back();
}

bool SlotPool::takeFromReaders(PooledSlot& slot)
{
  // What was never published is held by none, whatever bits say: they may be for memory that had this slot before.
  if (!isPublished(slot)) return true;
  if (!server_->table().take(slot.bit, slot.header().generation, slot.generation)) return false;
  slot.generation |= lease::kBusy;
  return true;
}

void SlotPool::discardUnneeded(std::size_t bytes)
{
  for (auto slot = slots_.begin(); slot != slots_.end();)
  {
    const bool idle = slots_.size() > limits_.min_slots && takes_ - slot->taken > kMaxIdleTakes;
    const bool unneeded = !slot->in_use && (idle || !fits(*slot, bytes)) && takeFromReaders(*slot);
    slot = unneeded ? discard(slot) : std::next(slot);
  }
}

/// Readers that hold it keep its memory; nobody writes there any more.
SlotPool::Slots::iterator SlotPool::discard(Slots::iterator slot)
{
  lease::publish(slot->header().generation, lease::kGone);
  server_->table().remove(slot->bit);
  server_->table().disclaim(slot->bit);
  bytes_ -= slot->file->mapping.bytes();
  return slots_.erase(slot);
}

/// Readers keep to their quota by themselves. Whoever does not is no reader of this package, and must not keep others
/// from their frames.
bool SlotPool::dismissGreedyReaders()
{
  std::vector<std::uint32_t> bits;
  std::uint64_t max_quota = 0;
  for (const PooledSlot& slot : slots_)
  {
    bits.push_back(slot.bit);
    max_quota = std::max(max_quota, slot.header().quota.load());
  }
  // A bit more is set for a moment while a reader looks whether a frame is there.
  const std::vector<std::uint64_t> greedy = server_->table().greedyReaders(bits, max_quota + 1);
  for (const std::uint64_t reader : greedy)
    server_->dismiss(reader);
  return !greedy.empty();
}

SlotAddress SlotPool::publish(PooledSlot& slot, std::size_t bytes)
{
  SlotAddress address;
  if (!isOfThisProcess()) return address;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!isPublished(slot))
  {
    slot.generation = server_->table().nextGeneration();
    lease::publish(slot.header().generation, slot.generation);
  }
  address.boot_id = bootId();
  address.socket = server_->socket();
  address.publisher = server_->publisher();
  address.slot = slot.bit;
  address.memory = slot.memory;
  address.generation = slot.generation;
  address.bytes = bytes;
  return address;
}

void SlotPool::giveBack(PooledSlot& slot)
{
  if (!isOfThisProcess()) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  slot.in_use = false;
  if (!rests_) return;
  const auto is_it = [&slot](const PooledSlot& other) { return &other == &slot; };
  discard(std::find_if(slots_.begin(), slots_.end(), is_it));
}

void SlotPool::rest()
{
  if (!isOfThisProcess()) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  rests_ = true;
  for (auto slot = slots_.begin(); slot != slots_.end();)
    slot = slot->in_use ? std::next(slot) : discard(slot);
}

SlotWriter::Counts SlotPool::counts() const
{
  if (!isOfThisProcess()) return {};
  const std::lock_guard<std::mutex> lock(mutex_);
  return {slots_.size(), bytes_, dropped_, reason_};
}

std::size_t SlotPool::readers() const
{
  if (!isOfThisProcess()) return 0;
  const std::lock_guard<std::mutex> lock(mutex_);
  return server_ ? server_->table().rows() : 0;
}

}  // namespace robot_vision
