#include "slot_connection.hpp"

#include <sys/socket.h>

#include <string>
#include <utility>

#include "lease_protocol.hpp"
#include "robot_vision/common/printable.hpp"
#include "seqpacket.hpp"
#include "shared_memory_error.hpp"
#include "slot_names.hpp"

namespace robot_vision
{
namespace
{

[[noreturn]] void fail(SharedMemoryFault fault, const std::string& reason)
{
  throw SharedMemoryError(fault, reason);
}

[[noreturn]] void failUnanswered(Received received)
{
  if (received == Received::kNothing)
    fail(SharedMemoryFault::kGone, "the publisher of images in shared memory does not answer");
  if (received == Received::kEnded)
    fail(SharedMemoryFault::kGone, "the publisher of images in shared memory has ended, or closed the connection");
  if (received == Received::kCut)
    fail(SharedMemoryFault::kNoDescriptors,
         "no descriptor is left in this process for an image in shared memory (ulimit -n)");
  fail(SharedMemoryFault::kRefused, "the publisher of images in shared memory gives an answer that is none");
}

std::uint64_t bitInWord(std::uint32_t bit)
{
  return std::uint64_t{1} << (bit % 64);
}

std::uint64_t checkedPublisher(const SlotAddress& address)
{
  if (address.boot_id != bootId() || bootId().empty())
    fail(SharedMemoryFault::kOtherHost, "the publisher of images in shared memory is on another host");
  if (!isSlotSocketName(address.socket))
    fail(SharedMemoryFault::kRefused, "'" + printable(address.socket) + "' is no socket of a publisher");
  return address.publisher;
}

}  // namespace

MappedSlot::MappedSlot(std::uint32_t bit_, std::uint64_t memory_, Mapping mapping)
  : bit(bit_),
    memory(memory_),
    pool(reinterpret_cast<const SlotHeader*>(mapping.data())->pool.load()),
    quota(reinterpret_cast<const SlotHeader*>(mapping.data())->quota.load()),
    mapping_(std::move(mapping))
{
}

bool MappedSlot::isGone() const
{
  return generation().load(std::memory_order_relaxed) == lease::kGone;
}

SlotConnection::SlotConnection(const SlotAddress& address, double timeout)
  : publisher_(checkedPublisher(address)), socket_(connectTo(address.socket, timeout)), holders_(kMaxSlots)
{
  if (!isOfThisUser(socket_))
    fail(SharedMemoryFault::kOtherUser, "the publisher of images in shared memory is another user's");
  MemoryFile row = makeMemoryFile("robot_vision row", kRowBytes);
  SlotGreeting greeting;
  greeting.publisher = publisher_;
  if (!send(socket_, greeting, row.descriptor)) failUnanswered(Received::kEnded);
  SlotWelcome welcome;
  Descriptor passed;
  const Received received = receive(socket_, welcome, passed);
  if (received != Received::kPacket || passed) failUnanswered(received);
  const SlotWelcome expected;
  if (welcome.magic != expected.magic || welcome.version != expected.version ||
      welcome.max_slots != expected.max_slots || welcome.publisher != publisher_)
    failUnanswered(Received::kFaulty);
  row_ = std::move(row.mapping);
}

SlotConnection::~SlotConnection() = default;

bool SlotConnection::hasEnded() const
{
  if (failed_) return true;
  char byte;
  return recv(socket_.get(), &byte, sizeof(byte), MSG_PEEK | MSG_DONTWAIT) == 0;
}

std::shared_ptr<MappedSlot> SlotConnection::slot(const SlotAddress& address)
{
  if (address.publisher != publisher_ || address.slot >= kMaxSlots || (address.generation & lease::kBusy) != 0)
    fail(SharedMemoryFault::kRefused, "a message names an image in shared memory that cannot be");
  std::shared_ptr<MappedSlot> slot = mapped(address);
  if (!slot) slot = request(address);
  if (address.bytes > slot->capacity())
    fail(SharedMemoryFault::kRefused, "a message names " + std::to_string(address.bytes) +
                                          " bytes of an image in shared memory that has room for " +
                                          std::to_string(slot->capacity()));
  return slot;
}

/// Null if this memory is new.
std::shared_ptr<MappedSlot> SlotConnection::mapped(const SlotAddress& address)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = slots_.find(address.slot);
  if (found == slots_.end() || found->second->memory < address.memory) return nullptr;
  if (found->second->memory == address.memory) return found->second;
  fail(SharedMemoryFault::kOverwritten, "the image was overwritten: its memory has been freed");
}

std::shared_ptr<MappedSlot> SlotConnection::request(const SlotAddress& address)
{
  const std::lock_guard<std::mutex> requests(requests_);
  if (std::shared_ptr<MappedSlot> slot = mapped(address)) return slot;  // by another thread meanwhile
  if (failed_) failUnanswered(Received::kEnded);
  SlotRequest request;
  request.memory = address.memory;
  request.slot = address.slot;
  SlotAnswer answer;
  Descriptor passed;
  Received received = send(socket_, request) ? receive(socket_, answer, passed) : Received::kEnded;
  if (received == Received::kPacket && (answer.memory != address.memory || answer.slot != address.slot))
    received = Received::kFaulty;
  failed_ = received != Received::kPacket && received != Received::kCut;
  if (received != Received::kPacket) failUnanswered(received);
  if (!passed) fail(SharedMemoryFault::kOverwritten, "the image was overwritten: its memory has been freed");
  auto slot = std::make_shared<MappedSlot>(address.slot, address.memory,
                                           mapForeignMemory(passed, kSlotHeaderBytes, kMaxMemoryFile));
  forgetGone();
  const std::lock_guard<std::mutex> lock(mutex_);
  slots_[address.slot] = slot;
  return slot;
}

void SlotConnection::forgetGone()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto slot = slots_.begin(); slot != slots_.end();)
    slot = slot->second->isGone() ? slots_.erase(slot) : std::next(slot);
}

SharedWord& SlotConnection::rowWord(std::uint32_t bit) const
{
  return reinterpret_cast<SharedWord*>(row_.data())[bit / 64];
}

void SlotConnection::hold(MappedSlot& slot, std::uint64_t generation)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  Holders& holders = holders_[slot.bit];
  bool held = false;
  if (holders.count > 0)
  {
    // The bit is set already, and must stay so if this is not the frame that it is set for.
    held = slot.generation().load(std::memory_order_acquire) == generation;
  }
  else
  {
    const auto of_pool = held_.find(slot.pool);
    if (of_pool != held_.end() && of_pool->second >= slot.quota)
      fail(SharedMemoryFault::kTooManyHeld, "this process holds " + std::to_string(of_pool->second) +
                                                " images of a publisher, the most that one reader may");
    held = lease::hold(rowWord(slot.bit), bitInWord(slot.bit), slot.generation(), generation);
    if (held) ++held_[holders.pool = slot.pool];
  }
  if (!held) fail(SharedMemoryFault::kOverwritten, "the image was overwritten before it could be held");
  ++holders.count;
}

void SlotConnection::release(MappedSlot& slot)
{
  if (!isOfThisProcess()) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  Holders& holders = holders_[slot.bit];
  if (--holders.count > 0) return;
  const auto of_pool = held_.find(holders.pool);
  if (--of_pool->second == 0) held_.erase(of_pool);
  lease::release(rowWord(slot.bit), bitInWord(slot.bit));
}

}  // namespace robot_vision
