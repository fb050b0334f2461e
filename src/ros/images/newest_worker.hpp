#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace robot_vision
{

/// Runs jobs in a thread of its own, one at a time and always the newest next. post() never waits: a job that has not
/// started when a newer one comes is dropped. The thread starts with the first job.
class NewestWorker
{
public:
  using Job = std::function<void()>;  // must not throw

  NewestWorker() = default;
  ~NewestWorker() { stop(); }
  NewestWorker(const NewestWorker&) = delete;
  NewestWorker& operator=(const NewestWorker&) = delete;

  /// Posts a job. If no thread can be started, the caller runs it. Does nothing after stop().
  void post(Job job);

  /// Drops the waiting job and returns when no job is running.
  void settle();

  /// Like settle(), but ends the thread; later jobs are dropped. Not to be called by a job.
  void stop();

private:
  bool hasThread();
  void run();

  std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  Job next_;  // empty if there is none
  bool running_ = false;
  bool stopped_ = false;
  std::thread thread_;
};

}  // namespace robot_vision
