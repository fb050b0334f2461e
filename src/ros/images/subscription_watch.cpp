#include "subscription_watch.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <vector>

namespace robot_vision
{
namespace
{

constexpr std::chrono::milliseconds kPeriod(200);

}  // namespace

class SubscriptionWatch::Work
{
public:
  void add(const std::shared_ptr<Watched>& subscription)
  {
    const auto expired = [](const std::weak_ptr<Watched>& other) { return other.expired(); };
    const std::lock_guard<std::mutex> lock(mutex_);
    subscriptions_.erase(std::remove_if(subscriptions_.begin(), subscriptions_.end(), expired), subscriptions_.end());
    subscriptions_.push_back(subscription);
  }

  void wake(bool end = false)
  {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      is_woken_ = true;
      ends_ = ends_ || end;
    }
    woken_.notify_all();
  }

  void run()
  {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!ends_)
    {
      is_woken_ = false;
      const std::vector<std::weak_ptr<Watched>> all = subscriptions_;
      lock.unlock();
      for (const std::weak_ptr<Watched>& one : all)
        if (const std::shared_ptr<Watched> subscription = one.lock()) subscription->review();
      lock.lock();
      woken_.wait_for(lock, kPeriod, [this] { return is_woken_; });
    }
  }

private:
  std::mutex mutex_;  // guards all below
  std::condition_variable woken_;
  bool is_woken_ = false, ends_ = false;
  std::vector<std::weak_ptr<Watched>> subscriptions_;
};

thread_local int SubscriptionWatch::Callback::depth_ = 0;

SubscriptionWatch::SubscriptionWatch() : work_(std::make_shared<Work>()), thread_([work = work_] { work->run(); })
{
}

SubscriptionWatch::~SubscriptionWatch()
{
  work_->wake(/*end=*/true);
  if (Callback::depth_ > 0)
    thread_.detach();
  else
    thread_.join();
}

void SubscriptionWatch::add(const std::shared_ptr<Watched>& subscription)
{
  work_->add(subscription);
  work_->wake();
}

std::function<void()> SubscriptionWatch::waker() const
{
  return [work = work_] { work->wake(); };
}

}  // namespace robot_vision
