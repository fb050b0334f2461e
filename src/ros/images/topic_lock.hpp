#pragma once

#include <chrono>
#include <mutex>

namespace robot_vision
{

/// Held while a list of roscpp's is changed that does not survive two threads at a time. There is one of each `Tag` in
/// a process, of which a thread may hold several.
template <class Tag>
class TopicLock
{
public:
  TopicLock() : lock_(mutex(), kTimeout) {}
  TopicLock(const TopicLock&) = delete;
  TopicLock& operator=(const TopicLock&) = delete;

private:
  /// Who holds it longer waits for a master, or is a nodelet that starts slowly: that must hold up nobody.
  static constexpr std::chrono::seconds kTimeout{2};

  static std::recursive_timed_mutex& mutex()
  {
    static auto* const mutex = new std::recursive_timed_mutex;  // outlives all that is withdrawn at the end
    return *mutex;
  }

  std::unique_lock<std::recursive_timed_mutex> lock_;
};

}  // namespace robot_vision
