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

/// Work in a thread of its own, one piece at a time, whose result is asked for now and then. But for abandon() it is
/// for one thread at a time.
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

  /// Begins; it must not be busy. Returns false if there is no thread for it.
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

  /// The result, if the work has ended and was not dropped. Throws what the work did.
  std::optional<Result> take()
  {
    if (!busy() || running_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
    thread_.join();
    std::future<Result> ended = std::move(running_);
    if (std::exchange(dropped_, false)) return std::nullopt;
    return ended.get();
  }

  /// The result of what is under way does not matter any more.
  void drop() { dropped_ = busy(); }

  /// The destructor is not to wait for what is under way, which must have all that it works with. Thread-safe.
  void abandon() { abandoned_ = true; }

private:
  std::thread thread_;           // joined before the next one
  std::future<Result> running_;  // its result
  bool dropped_ = false;
  std::atomic<bool> abandoned_{false};
};

}  // namespace robot_vision
