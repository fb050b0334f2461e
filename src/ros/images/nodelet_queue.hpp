#pragma once

#include <nodelet/detail/callback_queue.h>
#include <nodelet/detail/callback_queue_manager.h>

#include <atomic>
#include <cstdint>

namespace robot_vision
{

/// A queue of a nodelet, in which callbacks wait until it is opened, after onInit(). Those of a nodelet manager are
/// open from the beginning, so that others' nodelets may be called before they are ready.
class NodeletQueue : public nodelet::detail::CallbackQueue
{
public:
  explicit NodeletQueue(nodelet::detail::CallbackQueueManager& manager) : CallbackQueue(&manager), manager_(manager) {}

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override
  {
    ++added_;  // before the manager is told, which does not know the queue yet
    CallbackQueue::addCallback(callback, owner);
  }

  /// From now on the manager's threads call what is in the queue, if it is `threaded` several of them at a time. Each
  /// time that they are told of a callback they call one, so they are told of all that wait.
  void open(bool threaded)
  {
    manager_.addQueue(shared_from_this(), threaded);
    for (std::uint64_t waiting = added_; waiting > 0; --waiting)
      manager_.callbackAdded(shared_from_this());
  }

private:
  nodelet::detail::CallbackQueueManager& manager_;
  std::atomic<std::uint64_t> added_{0};  // callbacks
};

}  // namespace robot_vision
