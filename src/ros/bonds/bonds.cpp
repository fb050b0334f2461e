#include "bonds.hpp"

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <random>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "ros/images/advertising_lock.hpp"

namespace robot_vision
{
namespace
{

// What waits for a connection are the signs of all bonds, in the seconds after which one is missed.
constexpr std::uint32_t kQueueSize = 1000;
constexpr std::chrono::milliseconds kLastWords(200);  // that close() waits for answers
constexpr double kLongestWait = 1.0;                  // s, until it is seen that roscpp shuts down

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

Bonds::Bonds(const std::string& topic, const BondTimes& times) : times_(times), instance_(uniqueName())
{
  ros::NodeHandle nh;
  nh.setCallbackQueue(&queue_);
  gate_.guard(nh);
  bool is_disabled = false;
  ros::param::getCached(bond::Constants::DISABLE_HEARTBEAT_TIMEOUT_PARAM, is_disabled);  // asks the master now
  {
    const AdvertisingLock advertising;
    publisher_ = nh.advertise<bond::Status>(topic, kQueueSize);
  }
  subscriber_ = nh.subscribe<bond::Status>(topic, kQueueSize, [this](const auto& status) { take(*status); });
  if (!publisher_ || !subscriber_) throw std::runtime_error(topic + ": no bonds, as roscpp is shutting down");
  worker_ = std::thread([this] { work(); });
}

Bonds::~Bonds()
{
  close();
  subscriber_.shutdown();
  const AdvertisingLock advertising;
  publisher_.shutdown();
}

void Bonds::form(const std::string& id)
{
  const Clock::time_point now = Clock::now();
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = bonds_.find(id);
  if (closing_ || (found != bonds_.end() && !found->second.ended)) return;
  bonds_[id] = {now, now + nanoseconds(times_.connect), "", false};
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
    if (std::exchange(closing_, true)) return;
    const Clock::time_point now = Clock::now();
    for (auto& [id, one] : bonds_)
      endAt(one, now);
    waker_->wake();
    changed_.wait_for(lock, kLastWords, [this] { return closed_ || bonds_.empty(); });
    closed_ = true;
  }
  changed_.notify_all();
  waker_->wake();
  worker_.join();
  gate_.close();
}

void Bonds::work()
{
  for (bool closed = false; !closed;)
  {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      closed = closed_ = closed_ || ros::isShuttingDown();
    }
    queue_.callAvailable();
    const Clock::time_point next = giveSigns();
    publishNoted();
    if (!closed) waker_->waitUntil(next);
  }
  changed_.notify_all();
}

/// Takes a sign of another side. To be called by the worker, as the next two.
void Bonds::take(const bond::Status& status)
{
  if (status.instance_id == instance_) return;
  const Clock::time_point now = Clock::now();
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = bonds_.find(status.id);
  if (found == bonds_.end()) return;
  Bond& one = found->second;
  const bool is_first = one.other.empty();
  if (is_first) one.other = status.instance_id;
  if (one.other != status.instance_id) return;  // a bond is of two
  if (status.active)
  {
    if (one.ended) return;
    one.limit = now + nanoseconds(times_.heartbeat);
    if (is_first) one.sign = now;  // who was waited for waits for us
    return;
  }
  if (!one.ended)
  {
    note(status.id, false);  // the answer
    noteBroken(status.id);
  }
  bonds_.erase(found);
  changed_.notify_all();
}

/// Notes the signs that are due, and drops the bonds whose other side has given none. Returns when the next ones are.
Bonds::Clock::time_point Bonds::giveSigns()
{
  const Clock::time_point now = Clock::now();
  Clock::time_point next = now + nanoseconds(std::min(times_.period, kLongestWait));
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto it = bonds_.begin(); it != bonds_.end();)
  {
    auto& [id, one] = *it;
    if (isMissed(id, one, now))
    {
      if (!one.ended)
      {
        note(id, false);
        noteBroken(id);
      }
      it = bonds_.erase(it);
      changed_.notify_all();
      continue;
    }
    if (now >= one.sign)
    {
      note(id, !one.ended);
      one.sign = now + nanoseconds(one.ended ? bond::Constants::DEAD_PUBLISH_PERIOD : times_.period);
    }
    next = std::min({next, one.sign, one.limit});
    ++it;
  }
  return next;
}

/// Whether the other side has not been heard in time. If nothing is to be missed it has more time.
bool Bonds::isMissed(const std::string& id, Bond& one, Clock::time_point now)
{
  if (now < one.limit) return false;
  bool is_disabled = false;
  if (one.ended || one.other.empty() ||
      !ros::param::getCached(bond::Constants::DISABLE_HEARTBEAT_TIMEOUT_PARAM, is_disabled) || !is_disabled)
    return true;
  if (kept_.due())
    ROS_WARN("the bond %s is kept without signs of life, as %s is true", id.c_str(),
             bond::Constants::DISABLE_HEARTBEAT_TIMEOUT_PARAM.c_str());
  one.limit = now + nanoseconds(times_.heartbeat);
  return false;
}

void Bonds::note(const std::string& id, bool active)
{
  bond::Status status;
  status.header.stamp = ros::Time::now();
  status.id = id;
  status.instance_id = instance_;
  status.active = active;
  status.heartbeat_timeout = static_cast<float>(times_.heartbeat);
  status.heartbeat_period = static_cast<float>(times_.period);
  noted_.push_back(std::move(status));
}

void Bonds::noteBroken(const std::string& id)
{
  broken_.push(id);
  changed_.notify_all();
}

/// Publishes without the lock: while a topic of the process is withdrawn, roscpp makes this wait for the master.
void Bonds::publishNoted()
{
  std::vector<bond::Status> noted;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    noted.swap(noted_);
  }
  for (const bond::Status& status : noted)
    publisher_.publish(status);
}

void Bonds::endAt(Bond& one, Clock::time_point now) const
{
  one.ended = true;
  one.sign = now;
  one.limit = now + nanoseconds(times_.disconnect);
}

}  // namespace robot_vision
