#pragma once

#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <boost/function.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "subscription_watch.hpp"

namespace robot_vision
{

/// Subscribes to images over shared memory while every publisher of the topic offers that and can be read, and else
/// over raw, as always where this process publishes the topic itself. It follows the publishers as they come, go and
/// start again. Each frame comes once, whichever way; at a change one may be left out.
class AutoSubscription
{
public:
  using Callback = boost::function<void(const sensor_msgs::ImageConstPtr&)>;

  struct Params
  {
    std::string topic;  // a name for the NodeHandle, without /shm
    std::uint32_t queue_size = 1;
    ros::TransportHints hints;
    ros::VoidPtr tracked_object;
    bool wants_shared = false;  // whether it is worth a warning, given once, that images come over raw
  };

  /// The callback is called through the queue of `nh`, for one frame at a time.
  AutoSubscription(const ros::NodeHandle& nh, const Params& params, const Callback& callback);
  ~AutoSubscription() { shutdown(); }
  AutoSubscription(const AutoSubscription&) = delete;
  AutoSubscription& operator=(const AutoSubscription&) = delete;

  const std::string& topic() const { return topic_; }
  std::uint32_t publishers() const;
  /// Whether images come over shared memory now.
  bool isShared() const;

  /// Unsubscribes and waits for a running callback, unless it is that one which calls this.
  void shutdown();

private:
  class State;

  std::string topic_;
  std::shared_ptr<SubscriptionWatch> watch_;
  std::shared_ptr<State> state_;
};

}  // namespace robot_vision
