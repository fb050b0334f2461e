#pragma once

#include <cstdint>
#include <string>

namespace robot_vision
{

/// Where a published frame stands: which publisher's process, in which of its slots, and which of the frames that come
/// into that slot one after the other. It says nothing of what is in the pixels.
struct SlotAddress
{
  std::string boot_id;          // of the kernel that the publisher runs on
  std::string socket;           // the abstract name of the publisher's socket, without the leading zero
  std::uint64_t publisher = 0;  // a random number of the publisher's process
  std::uint32_t slot = 0;       // the bit of the slot in the rows of readers
  std::uint64_t memory = 0;     // the memory in the slot: a change of size brings another
  std::uint64_t generation = 0;
  std::uint64_t bytes = 0;  // of the pixels
};

/// The id of the running kernel, different on each host and after each start; empty if it cannot be read.
const std::string& bootId();

}  // namespace robot_vision
