#include "callback_gate.hpp"

#include <ros/callback_queue_interface.h>

#include <boost/make_shared.hpp>
#include <condition_variable>
#include <mutex>

namespace robot_vision
{

/// Who is inside. Callbacks that wait in a queue outlive the gate with it.
class CallbackGate::State
{
public:
  bool enter()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!closed_) ++inside_;
    return !closed_;
  }

  void leave()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (--inside_ == 0) empty_.notify_all();
  }

  void close()
  {
    std::unique_lock<std::mutex> lock(mutex_);
    closed_ = true;
    empty_.wait(lock, [this] { return inside_ == 0; });
  }

private:
  std::mutex mutex_;  // guards all below
  std::condition_variable empty_;
  bool closed_ = false;
  int inside_ = 0;
};

namespace
{

/// Does the work unless the gate is closed; false if it is.
template <class State, class Work>
bool pass(State& state, Work work)
{
  if (!state.enter()) return false;
  const auto leave = [](State* entered) { entered->leave(); };
  const std::unique_ptr<State, decltype(leave)> inside(&state, leave);
  work();
  return true;
}

}  // namespace

class CallbackGate::Callback : public ros::CallbackInterface
{
public:
  Callback(std::shared_ptr<State> state, ros::CallbackInterfacePtr callback)
    : state_(std::move(state)), callback_(std::move(callback))
  {
  }

  bool ready() override { return callback_->ready(); }

  CallResult call() override
  {
    CallResult result = Invalid;
    pass(*state_, [&] { result = callback_->call(); });
    return result;
  }

private:
  std::shared_ptr<State> state_;
  ros::CallbackInterfacePtr callback_;
};

/// The queue that a handle had, as long as the gate is open; then it may have gone.
class CallbackGate::Queue : public ros::CallbackQueueInterface
{
public:
  Queue(std::shared_ptr<State> state, ros::CallbackQueueInterface* queue) : state_(std::move(state)), queue_(queue) {}

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override
  {
    pass(*state_, [&] { queue_->addCallback(boost::make_shared<Callback>(state_, callback), owner); });
  }

  void removeByID(std::uint64_t owner) override
  {
    pass(*state_, [&] { queue_->removeByID(owner); });
  }

private:
  std::shared_ptr<State> state_;
  ros::CallbackQueueInterface* queue_;
};

CallbackGate::CallbackGate() : state_(std::make_shared<State>())
{
}

CallbackGate::~CallbackGate()
{
  close();
  if (!ros::isShuttingDown()) return;
  // Nothing has been unsubscribed then, and roscpp still knows the queues.
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

}  // namespace robot_vision
