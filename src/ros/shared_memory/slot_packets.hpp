#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

/// What publishers and readers of images in shared memory send each other, and how their memory looks. Both may be of
/// different versions of this package: kVersion changes with anything here.
namespace robot_vision
{

constexpr std::array<char, 8> kSlotMagic{'r', 'v', 's', 'l', 'o', 't', 's', '\0'};
constexpr std::uint32_t kSlotVersion = 1;
constexpr std::uint32_t kMaxSlots = 1024;  // of one publishing process

using SharedWord = std::atomic<std::uint64_t>;
static_assert(SharedWord::is_always_lock_free && sizeof(SharedWord) == 8, "leases need atomics that processes share");

/// The bits of the slots that a reader holds.
constexpr std::size_t kRowWords = kMaxSlots / 64;
constexpr std::size_t kRowBytes = kRowWords * sizeof(SharedWord);

/// What is at the start of a slot's memory; the pixels follow after kSlotHeaderBytes.
struct SlotHeader
{
  SharedWord generation;
  SharedWord pool;   // which of the process' pools it belongs to: a number
  SharedWord quota;  // how many slots of this pool a reader may hold
};
constexpr std::size_t kSlotHeaderBytes = 4096;
static_assert(sizeof(SlotHeader) <= kSlotHeaderBytes);

/// A reader's first packet, with the descriptor of its row.
struct SlotGreeting
{
  std::array<char, 8> magic = kSlotMagic;
  std::uint32_t version = kSlotVersion;
  std::uint32_t row_bytes = kRowBytes;
  std::uint64_t publisher = 0;  // that it expects
};

/// The answer to it. After anything that is not as it must be the socket is closed instead.
struct SlotWelcome
{
  std::array<char, 8> magic = kSlotMagic;
  std::uint32_t version = kSlotVersion;
  std::uint32_t max_slots = kMaxSlots;
  std::uint64_t publisher = 0;
};

/// A reader's later packets: asks for the memory in a slot.
struct SlotRequest
{
  std::uint64_t memory = 0;
  std::uint64_t slot = 0;
};

/// The answer to it, with the descriptor if that memory is still there.
struct SlotAnswer
{
  std::uint64_t memory = 0;
  std::uint64_t slot = 0;
};

}  // namespace robot_vision
