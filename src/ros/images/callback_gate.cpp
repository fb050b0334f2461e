#include "callback_gate.hpp"

#include <ros/callback_queue_interface.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <shared_mutex>

namespace robot_vision
{

/// Counts the callbacks that are running. Callbacks that wait in a queue share it, as they may outlive the gate.
class CallbackGate::State
{
public:
  /// Does the work, unless the gate is closed.
  template <class Work>
  void pass(const Work& work)
  {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (closed_) return;
      ++running_;
    }
    const auto leave = [](State* state) { state->leave(); };
    const std::unique_ptr<State, decltype(leave)> inside(this, leave);
    work();
  }

  /// Does the work of a callback.
  template <class Work>
  void call(const Work& work)
  {
    const std::shared_lock<std::shared_mutex> lock(calls_);
    pass(work);
  }

  void between(const Work& work)
  {
    const std::unique_lock<std::shared_mutex> lock(calls_);
    work();
  }

  void close()
  {
    std::unique_lock<std::mutex> lock(mutex_);
    closed_ = true;
    empty_.wait(lock, [this] { return running_ == 0; });
  }

private:
  void leave()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (--running_ == 0) empty_.notify_all();
  }

  std::shared_mutex calls_;  // shared by the callbacks that run
  std::mutex mutex_;         // guards all below
  std::condition_variable empty_;
  bool closed_ = false;
  int running_ = 0;
};

/// Whether the callbacks of a topic, a service or a timer have been removed from the queue.
using Removed = std::atomic<bool>;

class CallbackGate::Callback : public ros::CallbackInterface
{
public:
  Callback(std::shared_ptr<State> state, std::shared_ptr<const Removed> removed, ros::CallbackInterfacePtr callback)
    : state_(std::move(state)), removed_(std::move(removed)), callback_(std::move(callback))
  {
  }

  bool ready() override { return callback_->ready(); }

  CallResult call() override
  {
    CallResult result = Invalid;
    state_->call(
        [&]
        {
          // During the shutdown nothing is removed, and what the callbacks use may be gone.
          if (!*removed_ && !ros::isShuttingDown()) result = callback_->call();
        });
    return result;
  }

private:
  std::shared_ptr<State> state_;
  std::shared_ptr<const Removed> removed_;
  ros::CallbackInterfacePtr callback_;
};

/// Passes callbacks on to the handle's own queue while the gate is open. Later that queue may no longer exist. roscpp's
/// queue still calls what it has taken out when it is removed, so the callbacks look for themselves.
class CallbackGate::Queue : public ros::CallbackQueueInterface
{
public:
  Queue(std::shared_ptr<State> state, ros::CallbackQueueInterface* queue) : state_(std::move(state)), queue_(queue) {}

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override
  {
    state_->pass([&] { queue_->addCallback(boost::make_shared<Callback>(state_, removed(owner), callback), owner); });
  }

  void removeByID(std::uint64_t owner) override
  {
    state_->pass(
        [&]
        {
          remove(owner);
          queue_->removeByID(owner);
        });
  }

private:
  std::shared_ptr<Removed> removed(std::uint64_t owner)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::shared_ptr<Removed>& removed = owners_[owner];
    if (!removed) removed = std::make_shared<Removed>(false);
    return removed;
  }

  void remove(std::uint64_t owner)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = owners_.find(owner);
    if (found == owners_.end()) return;
    *found->second = true;
    owners_.erase(found);
  }

  std::shared_ptr<State> state_;
  ros::CallbackQueueInterface* queue_;
  std::mutex mutex_;                                          // guards owners_
  std::map<std::uint64_t, std::shared_ptr<Removed>> owners_;  // that have had callbacks
};

CallbackGate::CallbackGate() : state_(std::make_shared<State>())
{
}

CallbackGate::~CallbackGate()
{
  close();
  if (!ros::isShuttingDown()) return;
  // During the shutdown nothing is unsubscribed, and roscpp still refers to the queues, so they must stay.
  for (std::unique_ptr<Queue>& queue : queues_)
    queue.release();
}

void CallbackGate::guard(ros::NodeHandle& nh)
{
  queues_.push_back(std::make_unique<Queue>(state_, nh.getCallbackQueue()));
  nh.setCallbackQueue(queues_.back().get());
}

void CallbackGate::close()
{
  state_->close();
}

CallbackGate::Between CallbackGate::between() const
{
  return [state = state_](const Work& work) { state->between(work); };
}

}  // namespace robot_vision
