#pragma once

#include <atomic>
#include <cstdint>

/// How a reader and a writer that share nothing but memory agree who has a slot. The reader sets the slot's bit in its
/// row and then looks at the slot's generation; the writer marks the generation as busy and then looks at the rows.
/// Each has a fence in between: whichever comes second sees what the other has done, and gives way.
///
/// Word is std::atomic<std::uint64_t> or, in the tests, something that tells what is done with it. Fence is called
/// between the two steps.
namespace robot_vision::lease
{

/// The generation of a slot: an even number for each published frame, one more while the writer is at work on the
/// next, and kGone when the memory is no longer used.
constexpr std::uint64_t kBusy = 1;
constexpr std::uint64_t kGone = ~std::uint64_t{0};

struct FullFence
{
  void operator()() const { std::atomic_thread_fence(std::memory_order_seq_cst); }
};

/// Holds the slot of this bit if its frame is still the expected one. One thread at a time for each word of a row.
template <class Word, class Fence = FullFence>
bool hold(Word& row, std::uint64_t bit, const Word& generation, std::uint64_t expected, const Fence& fence = Fence())
{
  row.fetch_or(bit, std::memory_order_relaxed);
  fence();
  if (generation.load(std::memory_order_acquire) == expected) return true;
  row.fetch_and(~bit, std::memory_order_relaxed);  // nothing was read
  return false;
}

/// Gives the slot back; all of the pixels have been read before.
template <class Word>
void release(Word& row, std::uint64_t bit)
{
  row.fetch_and(~bit, std::memory_order_release);
}

/// Takes a slot to write into it, unless a reader holds it. `any_held` looks at all rows, reading with
/// std::memory_order_acquire. The first look spares readers a busy generation where it is known to be in vain.
template <class Word, class AnyHeld, class Fence = FullFence>
bool take(Word& generation, std::uint64_t published, const AnyHeld& any_held, const Fence& fence = Fence())
{
  if (any_held()) return false;
  generation.store(published | kBusy, std::memory_order_relaxed);
  fence();
  if (!any_held()) return true;
  generation.store(published, std::memory_order_release);
  return false;
}

/// Publishes what was written into a slot that was taken.
template <class Word>
void publish(Word& generation, std::uint64_t next)
{
  generation.store(next, std::memory_order_release);
}

}  // namespace robot_vision::lease
