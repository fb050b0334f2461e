#include "lazy_subscriber.hpp"

#include <utility>

#include "ros/params/params.hpp"

namespace robot_vision
{
namespace
{

constexpr double kUpdatePeriod = 1.0;  // s

}  // namespace

LazySubscriber::LazySubscriber(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, FrameStatistics& statistics,
                               std::function<bool()> is_wanted, std::function<void(bool)> listen)
  : nh_(nh),
    name_(pnh.getNamespace()),
    statistics_(statistics),
    is_wanted_(std::move(is_wanted)),
    listen_(std::move(listen))
{
  readParam(pnh, "always_subscribe", always_subscribe_);
}

void LazySubscriber::start()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    running_ = true;
  }
  if (const std::exception_ptr error = look()) std::rethrow_exception(error);
  // A topic that is withdrawn does not tell that its subscribers are gone.
  timer_ = nh_.createWallTimer(ros::WallDuration(kUpdatePeriod), [this](const ros::WallTimerEvent&) { update(); });
}

void LazySubscriber::update()
{
  look();  // what that returns would end the process, as roscpp calls this
}

/// Subscribes or not. Returns what was thrown, which it has told, or null.
std::exception_ptr LazySubscriber::look()
{
  std::unique_lock<std::mutex> lock(mutex_);
  changed_ = true;
  if (updating_) return nullptr;
  updating_ = true;
  std::exception_ptr error;
  while (running_ && !error && std::exchange(changed_, false))
  {
    lock.unlock();  // because the master is asked, and callbacks must not wait for that
    try
    {
      listenIfWanted();
    }
    catch (const std::exception& e)
    {
      error = std::current_exception();
      tell(e.what());
    }
    lock.lock();
  }
  updating_ = false;
  updated_.notify_all();
  return error;
}

void LazySubscriber::listenIfWanted()
{
  const bool wanted = always_subscribe_ || is_wanted_();
  if (listens_ == wanted) return;
  listens_.reset();
  listen_(wanted);
  listens_ = wanted;
}

void LazySubscriber::tell(const std::string& reason)
{
  const std::string what = statistics_.setUnsubscribed(reason);
  if (throttle_.due()) ROS_ERROR("%s: %s", name_.c_str(), what.c_str());
}

void LazySubscriber::stop()
{
  timer_.stop();
  std::unique_lock<std::mutex> lock(mutex_);
  running_ = false;
  updated_.wait(lock, [this] { return !updating_; });
}

}  // namespace robot_vision
