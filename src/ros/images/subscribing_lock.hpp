#pragma once

#include <ros/subscriber.h>

#include "topic_lock.hpp"

namespace robot_vision
{

/// Held while topics that nodes of a process may have in common are subscribed to in roscpp, or that ends.
/// TopicManager::unsubscribe() finds a subscription without callbacks, and then removes it from its list, whether or
/// not another thread has given it a callback meanwhile: that one would never get a message.
using SubscribingLock = TopicLock<struct Subscribing>;

/// Unsubscribes with that lock, and waits for a running callback.
inline void endSubscription(ros::Subscriber& subscriber)
{
  const SubscribingLock subscribing;
  subscriber.shutdown();
}

}  // namespace robot_vision
