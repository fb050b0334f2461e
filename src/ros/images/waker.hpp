#pragma once

#include <ros/callback_queue.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

namespace robot_vision
{

/// Wakes the one thread that waits for work. Thread-safe.
class Waker
{
public:
  void wake()
  {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      awake_ = true;
    }
    woken_.notify_one();
  }

  using Clock = std::chrono::steady_clock;

  /// Returns true at once if wake() was called since the last wait, true when it is, or false at the deadline.
  bool waitUntil(Clock::time_point deadline)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    const bool woken = woken_.wait_until(lock, deadline, [this] { return awake_; });
    awake_ = false;
    return woken;
  }

private:
  std::mutex mutex_;  // guards all below
  std::condition_variable woken_;
  bool awake_ = false;
};

/// A callback queue of roscpp that calls `Wake` when there is something in it.
template <class Wake>
class WakingQueue : public ros::CallbackQueue
{
public:
  explicit WakingQueue(Wake wake) : wake_(std::move(wake)) {}

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override
  {
    ros::CallbackQueue::addCallback(callback, owner);
    wake_();
  }

private:
  Wake wake_;
};

}  // namespace robot_vision
