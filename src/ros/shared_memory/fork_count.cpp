#include "fork_count.hpp"

#include <pthread.h>
#include <unistd.h>

#include <mutex>
#include <set>

namespace robot_vision
{
namespace
{

struct ForkState
{
  std::atomic<unsigned> forks{0};
  std::mutex mutex;      // guards what is below; held during a fork, so that the child finds it in order
  std::set<int> opened;  // by Descriptor
};

ForkState& state()
{
  static ForkState& only = []() -> ForkState&
  {
    static auto* made = new ForkState;  // lives longer than all static objects
    pthread_atfork([] { made->mutex.lock(); }, [] { made->mutex.unlock(); },
                   []
                   {
                     for (const int number : made->opened)
                       close(number);
                     made->opened.clear();  // The child's own files get these numbers, which its children keep.
                     made->forks.fetch_add(1);
                     made->mutex.unlock();
                   });
    return *made;
  }();
  return only;
}

}  // namespace

unsigned forkCount()
{
  return state().forks.load(std::memory_order_relaxed);
}

Descriptor::Descriptor(int number) : number_(number), forks_(forkCount())
{
  if (number_ < 0) return;
  const std::lock_guard<std::mutex> lock(state().mutex);
  state().opened.insert(number_);
}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept
{
  if (this == &other) return *this;
  reset();
  number_ = std::exchange(other.number_, -1);
  forks_ = other.forks_;
  return *this;
}

void Descriptor::reset()
{
  const int number = std::exchange(number_, -1);
  if (number < 0 || forks_ != forkCount()) return;
  const std::lock_guard<std::mutex> lock(state().mutex);
  state().opened.erase(number);
  close(number);
}

}  // namespace robot_vision
