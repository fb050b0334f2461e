#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace robot_vision
{

/// Does in a thread of its own, one after the other, what it is given: the newest always next. Who gives never waits;
/// what has not begun when something newer comes is dropped. The thread starts with the first job.
class NewestWorker
{
public:
  using Job = std::function<void()>;  // must not throw

  NewestWorker() = default;
  ~NewestWorker() { stop(); }
  NewestWorker(const NewestWorker&) = delete;
  NewestWorker& operator=(const NewestWorker&) = delete;

  /// Has the job done, if need be by the caller: when no thread can be started. Does nothing after stop().
  void post(Job job);

  /// Drops what waits, and returns when nothing is under way.
  void settle();

  /// The same, for ever. Not to be called by a job.
  void stop();

private:
  bool hasThread();
  void run();

  std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  Job next_;  // empty: there is none
  bool busy_ = false;
  bool stopped_ = false;
  std::thread thread_;
};

}  // namespace robot_vision
