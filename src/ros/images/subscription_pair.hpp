#pragma once

#include <robot_vision/ShmImage.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <boost/function.hpp>
#include <boost/weak_ptr.hpp>
#include <cstdint>
#include <mutex>
#include <string>

#include "frame_handover.hpp"

namespace robot_vision
{

/// The subscriptions of roscpp to the images of a topic, over raw and over shared memory, of which there may be none,
/// one or both. Thread-safe. The master is asked without a lock.
class SubscriptionPair
{
public:
  using Way = FrameHandover::Way;

  struct Params
  {
    std::string name;  // of the topic for the NodeHandle, without /shm
    std::uint32_t queue_size = 1;
    ros::TransportHints hints;
    ros::VoidPtr tracked_object;  // which this does not keep alive; there are no callbacks after its end
  };
  template <class Message>
  using Callback = boost::function<void(const boost::shared_ptr<const Message>&)>;

  /// The callbacks are called through the queue of `nh`.
  SubscriptionPair(const ros::NodeHandle& nh, Params params);
  ~SubscriptionPair();
  SubscriptionPair(const SubscriptionPair&) = delete;
  SubscriptionPair& operator=(const SubscriptionPair&) = delete;

  const std::string& topic() const { return topic_; }  // absolute
  std::string sharedTopic() const { return topic_ + "/shm"; }

  /// Subscribes, unless there is a subscription already or the pair is closed. Returns whether it does. Throws
  /// ros::Exception if this process subscribes to the topic as one of another type.
  bool openRaw(const Callback<sensor_msgs::Image>& callback);
  bool openShared(const Callback<ShmImage>& callback);
  /// Unsubscribes and waits for a running callback, unless it is that one which calls this. Returns whether there was
  /// a subscription.
  bool drop(Way way);
  /// From now on none is opened.
  void close();

  /// Connections of the subscription, 0 if there is none.
  std::uint32_t publishers(Way way) const;

private:
  bool open(Way way, ros::SubscribeOptions options);
  bool isWanted(Way way) const;
  void keep(Way way, ros::Subscriber subscriber);
  ros::Subscriber& member(Way way) { return way == Way::kRaw ? raw_ : shared_; }
  const ros::Subscriber& member(Way way) const { return way == Way::kRaw ? raw_ : shared_; }

  ros::NodeHandle nh_;
  const std::string topic_;
  Params params_;  // whose tracked object is null
  const bool is_tracked_;
  const boost::weak_ptr<void> tracked_object_;
  mutable std::mutex mutex_;  // guards all below
  bool closed_ = false;
  ros::Subscriber raw_, shared_;
};

}  // namespace robot_vision
