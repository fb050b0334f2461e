#include "slot_reader.hpp"

#include <utility>

#include "slot_connection.hpp"

namespace robot_vision
{
namespace
{

/// The connections of this process, by the names of their sockets.
struct Connections
{
  std::mutex mutex;
  std::map<std::string, std::weak_ptr<SlotConnection>> open;
};

std::shared_ptr<SlotConnection> connectOnce(const SlotAddress& address, double timeout)
{
  static PerProcess<Connections> of_processes;
  Connections& connections = of_processes.get();
  const std::lock_guard<std::mutex> lock(connections.mutex);
  for (auto entry = connections.open.begin(); entry != connections.open.end();)
    entry = entry->second.expired() ? connections.open.erase(entry) : std::next(entry);
  const auto found = connections.open.find(address.socket);
  std::shared_ptr<SlotConnection> connection = found == connections.open.end() ? nullptr : found->second.lock();
  if (connection && !connection->hasEnded()) return connection;
  connection = std::make_shared<SlotConnection>(address, timeout);
  connections.open[address.socket] = connection;
  return connection;
}

}  // namespace

HeldSlot::HeldSlot(std::shared_ptr<SlotConnection> connection, std::shared_ptr<MappedSlot> slot,
                   const SlotAddress& address)
  : connection_(std::move(connection)), slot_(std::move(slot)), data_(slot_->pixels()), bytes_(address.bytes)
{
  connection_->hold(*slot_, address.generation);
}

HeldSlot::~HeldSlot()
{
  connection_->release(*slot_);
}

std::uint64_t HeldSlot::quota() const
{
  return slot_->quota;
}

SlotReader::SlotReader(double timeout) : timeout_(timeout)
{
}
SlotReader::~SlotReader() = default;

std::shared_ptr<const HeldSlot> SlotReader::hold(const SlotAddress& address)
{
  if (forks_ != forkCount())
    throw SharedMemoryError(SharedMemoryFault::kGone, "the reader of images in shared memory is the parent process'");
  const std::shared_ptr<SlotConnection> connection = this->connection(address);
  try
  {
    return std::make_shared<HeldSlot>(connection, connection->slot(address), address);
  }
  catch (const SharedMemoryError& error)
  {
    if (!error.concernsOneFrame()) forgetEnded();
    throw;
  }
}

std::shared_ptr<SlotConnection> SlotReader::connection(const SlotAddress& address)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = connections_.find(address.socket);
    if (found != connections_.end()) return found->second;
  }
  forgetEnded();
  std::shared_ptr<SlotConnection> connection = connectOnce(address, timeout_);
  const std::lock_guard<std::mutex> lock(mutex_);
  connections_[address.socket] = connection;
  return connection;
}

void SlotReader::forgetEnded()
{
  if (forks_ != forkCount()) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto entry = connections_.begin(); entry != connections_.end();)
  {
    entry->second->forgetGone();
    entry = entry->second->hasEnded() ? connections_.erase(entry) : std::next(entry);
  }
}

}  // namespace robot_vision
