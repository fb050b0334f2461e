#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "fork_count.hpp"
#include "shared_memory_error.hpp"
#include "slot_address.hpp"

namespace robot_vision
{

class MappedSlot;
class SlotConnection;

/// A published frame that this process holds: its pixels are not overwritten while this exists, and stay readable even
/// if the publisher or the reader that gave it ends.
class HeldSlot
{
public:
  /// Throws SharedMemoryError.
  HeldSlot(std::shared_ptr<SlotConnection> connection, std::shared_ptr<MappedSlot> slot, const SlotAddress& address);
  ~HeldSlot();
  HeldSlot(const HeldSlot&) = delete;
  HeldSlot& operator=(const HeldSlot&) = delete;

  /// The pixels, at a multiple of 4096 bytes. The memory cannot be written.
  const std::uint8_t* data() const { return data_; }
  std::size_t bytes() const { return bytes_; }
  /// How many frames of this topic the publisher lets a process hold, as it said at first.
  std::uint64_t quota() const;

private:
  std::shared_ptr<SlotConnection> connection_;
  std::shared_ptr<MappedSlot> slot_;
  const std::uint8_t* data_;
  std::size_t bytes_;
};

/// Holds frames of the publishers of a topic. Readers of the same process share their connections, of which there is
/// one to each publishing process. Thread-safe.
class SlotReader
{
public:
  /// On the connections that this reader makes an answer of a publisher's process is waited for at most `timeout` (s).
  explicit SlotReader(double timeout = kTimeout);
  ~SlotReader();

  /// Connects to the publisher, if this has not happened yet, maps the slot, if it has not been, and holds the frame.
  /// Never null. Throws SharedMemoryError. Waits for the publisher's process only for what is new: the connection and
  /// the first frame in each slot.
  std::shared_ptr<const HeldSlot> hold(const SlotAddress& address);

  /// Forgets connections to publishers that have ended, with the memory of theirs that nothing holds. hold() does it,
  /// too, whenever it meets a new publisher.
  void forgetEnded();

  static constexpr double kTimeout = 1.0;  // s

private:
  std::shared_ptr<SlotConnection> connection(const SlotAddress& address);

  const double timeout_;
  const unsigned forks_ = forkCount();
  std::mutex mutex_;                                                    // guards connections_
  std::map<std::string, std::shared_ptr<SlotConnection>> connections_;  // by the name of the socket
};

}  // namespace robot_vision
