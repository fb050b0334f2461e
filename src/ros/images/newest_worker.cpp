#include "newest_worker.hpp"

#include <system_error>
#include <utility>

namespace robot_vision
{

void NewestWorker::post(Job job)
{
  std::unique_lock<std::mutex> lock(mutex_);
  if (stopped_) return;
  const bool threaded = hasThread();
  if (threaded) next_.swap(job);  // the replaced job is destroyed without the lock
  lock.unlock();
  if (threaded)
    changed_.notify_all();
  else
    job();
}

bool NewestWorker::hasThread()
{
  try
  {
    if (!thread_.joinable()) thread_ = std::thread(&NewestWorker::run, this);
    return true;
  }
  catch (const std::system_error&)
  {
    return false;
  }
}

void NewestWorker::settle()
{
  std::unique_lock<std::mutex> lock(mutex_);
  next_ = nullptr;
  changed_.wait(lock, [this] { return !running_; });
}

void NewestWorker::stop()
{
  std::thread ended;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopped_ = true;
    next_ = nullptr;
    ended.swap(thread_);
  }
  changed_.notify_all();
  if (ended.joinable()) ended.join();
}

void NewestWorker::run()
{
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;)
  {
    changed_.wait(lock, [this] { return stopped_ || next_; });
    if (stopped_) return;
    {
      const Job job = std::exchange(next_, nullptr);
      running_ = true;
      lock.unlock();
      job();
    }
    lock.lock();
    running_ = false;
    changed_.notify_all();
  }
}

}  // namespace robot_vision
