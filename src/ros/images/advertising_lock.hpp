#pragma once

#include <chrono>
#include <mutex>

namespace robot_vision
{

/// Held while topics of this process are advertised in roscpp, or withdrawn. TopicManager::unadvertise() keeps its
/// place in the list of topics while that is not locked: if two threads change the list at a time, it forgets a topic
/// of somebody else, and roscpp ends the process at the next message there. A thread may hold several.
class AdvertisingLock
{
public:
  AdvertisingLock() : lock_(mutex(), kTimeout) {}
  AdvertisingLock(const AdvertisingLock&) = delete;
  AdvertisingLock& operator=(const AdvertisingLock&) = delete;

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
