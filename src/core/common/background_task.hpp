#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

namespace robot_vision
{

/// Runs one piece of work at a time in a thread of its own. The owner asks for the result now and then, and never has
/// to wait for it. For one thread at a time, except for abandon().
template <class Result>
class BackgroundTask
{
public:
  BackgroundTask() = default;
  ~BackgroundTask()
  {
    if (!thread_.joinable()) return;
    if (abandoned_)
      thread_.detach();
    else
      thread_.join();
  }
  BackgroundTask(const BackgroundTask&) = delete;
  BackgroundTask& operator=(const BackgroundTask&) = delete;

  /// Whether work is under way, or its result has not been taken.
  bool busy() const { return running_.valid(); }

  /// Waits for the end of work that is under way.
  void wait() const
  {
    if (busy()) running_.wait();
  }

  /// Starts the work; the task must not be busy. Returns false if no thread can be started.
  template <class Work>
  bool start(Work work)
  {
    std::packaged_task<Result()> task(std::move(work));
    std::future<Result> result = task.get_future();
    try
    {
      thread_ = std::thread(std::move(task));
    }
    catch (const std::system_error&)
    {
      return false;
    }
    running_ = std::move(result);
    return true;
  }

  /// The result, if the work has ended and was not dropped. Throws what the work has thrown.
  std::optional<Result> take()
  {
    if (!busy() || running_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
    thread_.join();
    std::future<Result> ended = std::move(running_);
    if (std::exchange(dropped_, false)) return std::nullopt;
    return ended.get();
  }

  /// Makes take() return nothing for work that is under way, and throw nothing.
  void drop() { dropped_ = busy(); }

  /// Makes the destructor return without waiting for work that is under way, which then must not use anything that may
  /// be destroyed before it ends. Thread-safe.
  void abandon() { abandoned_ = true; }

private:
  std::thread thread_;           // joined before the next one starts
  std::future<Result> running_;  // the result of the work that was started last, until it is taken
  bool dropped_ = false;
  std::atomic<bool> abandoned_{false};
};

}  // namespace robot_vision
