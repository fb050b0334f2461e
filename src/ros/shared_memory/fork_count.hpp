#pragma once

#include <atomic>
#include <utility>

namespace robot_vision
{

/// The number of forks between this process and the one that was started: what was made under another number belongs
/// to the parent. A child has its mappings and descriptors, but none of its threads.
unsigned forkCount();

/// A file descriptor, closed at the end and in forked children, so that a child keeps neither sockets nor memory of its
/// parent alive.
class Descriptor
{
public:
  Descriptor() = default;
  explicit Descriptor(int number);  // negative: none
  ~Descriptor() { reset(); }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)), forks_(other.forks_) {}
  Descriptor& operator=(Descriptor&& other) noexcept;

  int get() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }
  void reset();

private:
  int number_ = -1;
  unsigned forks_ = 0;
};

/// One object for each process: a forked child gets a new one when it asks, as the mutex in the parent's may be locked
/// for ever. None is ever destroyed.
template <class Object>
class PerProcess
{
public:
  Object& get()
  {
    Entry* entry = entry_.load();
    while (entry == nullptr || entry->forks != forkCount())
    {
      auto* made = new Entry;
      if (entry_.compare_exchange_strong(entry, made)) return made->object;
      delete made;
    }
    return entry->object;
  }

private:
  struct Entry
  {
    unsigned forks = forkCount();
    Object object;
  };
  std::atomic<Entry*> entry_{nullptr};
};

}  // namespace robot_vision
