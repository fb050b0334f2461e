#include "bonds.hpp"

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <random>
#include <sstream>

#include "ros/images/advertising_lock.hpp"

namespace robot_vision
{
namespace
{

// What waits for a connection are the signs of all bonds, in the seconds after which one is missed.
constexpr std::uint32_t kQueueSize = 1000;
constexpr std::chrono::milliseconds kLastWords(200);  // that close() waits for answers

std::chrono::nanoseconds nanoseconds(double seconds)
{
  return std::chrono::nanoseconds(static_cast<std::int64_t>(seconds * 1e9));
}

/// A name that no other process gives.
std::string uniqueName()
{
  std::random_device random;
  std::ostringstream name;
  name << std::hex << std::setfill('0');
  for (int i = 0; i < 4; ++i)
    name << std::setw(8) << random();
  return name.str();
}

}  // namespace

Bonds::Bonds(const std::string& topic, const BondTimes& times) : times_(times)
{
  ros::NodeHandle nh;
  nh.setCallbackQueue(&queue_);
  gate_.guard(nh);
  nh.param(bond::Constants::DISABLE_HEARTBEAT_TIMEOUT_PARAM, patient_, false);
  {
    const AdvertisingLock advertising;
    publisher_ = nh.advertise<bond::Status>(topic, kQueueSize);
  }
  subscriber_ = nh.subscribe<bond::Status>(topic, kQueueSize, [this](const auto& status) { take(*status); });
  worker_ = std::thread([this] { work(); });
}

void Bonds::form(const std::string& id)
{
  const Clock::time_point now = Clock::now();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (closed_) return;
  bonds_[id] = {uniqueName(), false, now, now + nanoseconds(times_.connect)};
  waker_->wake();
}

void Bonds::end(const std::string& id)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = bonds_.find(id);
  if (found == bonds_.end()) return;
  endAt(found->second, Clock::now());
  waker_->wake();
}

std::string Bonds::nextBroken()
{
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return closed_ || !broken_.empty(); });
  if (closed_) return "";
  std::string id = std::move(broken_.front());
  broken_.pop();
  return id;
}

void Bonds::close()
{
  {
    std::unique_lock<std::mutex> lock(mutex_);
    if (closed_) return;
    for (auto& [id, one] : bonds_)
      endAt(one, Clock::now());
    waker_->wake();
    changed_.wait_for(lock, kLastWords, [this] { return bonds_.empty(); });
    closed_ = true;
  }
  changed_.notify_all();
  waker_->wake();
  worker_.join();
  gate_.close();
  subscriber_.shutdown();
  const AdvertisingLock advertising;
  publisher_.shutdown();
}

void Bonds::work()
{
  for (;;)
  {
    queue_.callAvailable();
    waker_->waitUntil(giveSigns());
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return;
  }
}

void Bonds::take(const bond::Status& status)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = bonds_.find(status.id);
  if (found == bonds_.end() || status.instance_id == found->second.instance) return;
  Bond& one = found->second;
  if (status.active)
  {
    if (!one.ended) one.limit = Clock::now() + nanoseconds(times_.heartbeat);
    return;
  }
  if (!one.ended)
  {
    publish(status.id, one, false);  // the answer
    noteBroken(status.id);
  }
  bonds_.erase(found);
  changed_.notify_all();
}

/// Gives the signs that are due, and drops the bonds whose other side has given none. Returns when the next ones are.
Bonds::Clock::time_point Bonds::giveSigns()
{
  const Clock::time_point now = Clock::now();
  Clock::time_point next = now + nanoseconds(times_.period);
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto it = bonds_.begin(); it != bonds_.end();)
  {
    auto& [id, one] = *it;
    if (counts(one) && now >= one.limit)
    {
      if (!one.ended)
      {
        publish(id, one, false);
        noteBroken(id);
      }
      it = bonds_.erase(it);
      changed_.notify_all();
      continue;
    }
    if (now >= one.sign)
    {
      publish(id, one, !one.ended);
      one.sign = now + nanoseconds(one.ended ? bond::Constants::DEAD_PUBLISH_PERIOD : times_.period);
    }
    next = std::min(next, one.sign);
    if (counts(one)) next = std::min(next, one.limit);
    ++it;
  }
  return next;
}

void Bonds::publish(const std::string& id, const Bond& one, bool active)
{
  bond::Status status;
  status.header.stamp = ros::Time::now();
  status.id = id;
  status.instance_id = one.instance;
  status.active = active;
  status.heartbeat_timeout = static_cast<float>(times_.heartbeat);
  status.heartbeat_period = static_cast<float>(times_.period);
  publisher_.publish(status);
}

void Bonds::endAt(Bond& one, Clock::time_point now)
{
  one.ended = true;
  one.sign = now;
  one.limit = now + nanoseconds(bond::Constants::DEFAULT_DISCONNECT_TIMEOUT);
}

void Bonds::noteBroken(const std::string& id)
{
  broken_.push(id);
  changed_.notify_all();
}

}  // namespace robot_vision
