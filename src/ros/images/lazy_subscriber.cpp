#include "lazy_subscriber.hpp"

#include <exception>
#include <utility>

#include "ros/params/params.hpp"

namespace robot_vision
{
namespace
{

constexpr double kUpdatePeriod = 1.0;  // s

}  // namespace

LazySubscriber::LazySubscriber(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, std::function<bool()> is_wanted,
                               std::function<void(bool)> listen)
  : nh_(nh), is_wanted_(std::move(is_wanted)), listen_(std::move(listen))
{
  readParam(pnh, "always_subscribe", always_subscribe_);
}

void LazySubscriber::start()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    running_ = true;
  }
  update();
  // The loader of nodelets drops callbacks until onInit() returns, also those of subscribers that come meanwhile; and a
  // topic that is withdrawn does not tell that its subscribers are gone.
  timer_ = nh_.createWallTimer(ros::WallDuration(kUpdatePeriod), [this](const ros::WallTimerEvent&) { update(); });
}

void LazySubscriber::update()
{
  std::unique_lock<std::mutex> lock(mutex_);
  changed_ = true;
  if (updating_) return;
  updating_ = true;
  std::exception_ptr error;
  while (running_ && !error && std::exchange(changed_, false))
  {
    lock.unlock();  // because the master is asked, and callbacks must not wait for that
    try
    {
      listenIfWanted();
    }
    catch (...)
    {
      error = std::current_exception();
    }
    lock.lock();
  }
  updating_ = false;
  updated_.notify_all();
  if (error) std::rethrow_exception(error);
}

void LazySubscriber::listenIfWanted()
{
  const bool wanted = always_subscribe_ || is_wanted_();
  if (wanted == listens_) return;
  listen_(wanted);
  listens_ = wanted;
}

void LazySubscriber::stop()
{
  timer_.stop();
  std::unique_lock<std::mutex> lock(mutex_);
  running_ = false;
  updated_.wait(lock, [this] { return !updating_; });
}

}  // namespace robot_vision
