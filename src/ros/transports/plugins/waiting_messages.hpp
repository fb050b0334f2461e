#pragma once

#include <ros/callback_queue_interface.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <cstdint>
#include <memory>

namespace robot_vision
{

/// Hands the messages of one subscription on to a callback queue, and counts those that wait there, which roscpp does
/// not tell. It must outlive the subscription. Thread-safe.
class WaitingMessages : public ros::CallbackQueueInterface
{
public:
  explicit WaitingMessages(ros::CallbackQueueInterface& queue) : queue_(queue) {}

  /// The number of messages behind the one whose callback runs.
  std::int64_t count() const { return *count_; }

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) override
  {
    ++*count_;
    queue_.addCallback(boost::make_shared<Counted>(callback, count_), owner_id);
  }
  void removeByID(std::uint64_t owner_id) override { queue_.removeByID(owner_id); }

private:
  using Count = std::shared_ptr<std::atomic<std::int64_t>>;

  class Counted : public ros::CallbackInterface
  {
  public:
    Counted(const ros::CallbackInterfacePtr& callback, Count count) : callback_(callback), count_(std::move(count)) {}

    bool ready() override { return callback_->ready(); }
    CallResult call() override
    {
      --*count_;
      const CallResult result = callback_->call();
      if (result == TryAgain) ++*count_;
      return result;
    }

  private:
    ros::CallbackInterfacePtr callback_;
    Count count_;
  };

  ros::CallbackQueueInterface& queue_;
  Count count_ = std::make_shared<std::atomic<std::int64_t>>(0);
};

}  // namespace robot_vision
