#include "slot_writer.hpp"

#include <map>
#include <mutex>
#include <utility>

#include "slot_pool.hpp"

namespace robot_vision
{
namespace
{

/// The slots that this process has in use, by their pixels.
struct SlotsInUse
{
  std::mutex mutex;
  std::map<const std::uint8_t*, std::weak_ptr<WritableSlot>> slots;
};

SlotsInUse& slotsInUse()
{
  static PerProcess<SlotsInUse> of_processes;
  return of_processes.get();
}

}  // namespace

WritableSlot::WritableSlot(std::shared_ptr<SlotPool> pool, PooledSlot& slot, std::size_t bytes)
  : pool_(std::move(pool)), slot_(slot), data_(slot.pixels()), bytes_(bytes)
{
}

WritableSlot::~WritableSlot()
{
  SlotsInUse& in_use = slotsInUse();
  {
    const std::lock_guard<std::mutex> lock(in_use.mutex);
    in_use.slots.erase(data_);
  }
  pool_->giveBack(slot_);
}

SlotAddress WritableSlot::publish()
{
  return pool_->publish(slot_, bytes_);
}

std::shared_ptr<WritableSlot> findSlot(const std::uint8_t* pixels)
{
  SlotsInUse& in_use = slotsInUse();
  const std::lock_guard<std::mutex> lock(in_use.mutex);
  const auto found = in_use.slots.find(pixels);
  return found == in_use.slots.end() ? nullptr : found->second.lock();
}

SlotWriter::SlotWriter(const Limits& limits) : SlotWriter(limits, nullptr)
{
}

SlotWriter::SlotWriter(const Limits& limits, std::shared_ptr<SlotServer> server)
  : pool_(std::make_shared<SlotPool>(limits, std::move(server)))
{
}

SlotWriter::~SlotWriter()
{
  pool_->rest();
}

std::shared_ptr<WritableSlot> SlotWriter::take(std::size_t bytes)
{
  std::shared_ptr<WritableSlot> slot = pool_->take(bytes);
  if (!slot) return slot;
  SlotsInUse& in_use = slotsInUse();
  const std::lock_guard<std::mutex> lock(in_use.mutex);
  in_use.slots[slot->data()] = slot;
  return slot;
}

void SlotWriter::rest()
{
  pool_->rest();
}

SlotWriter::Counts SlotWriter::counts() const
{
  return pool_->counts();
}

std::size_t SlotWriter::readers() const
{
  return pool_->readers();
}

}  // namespace robot_vision
