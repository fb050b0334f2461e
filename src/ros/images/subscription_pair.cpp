#include "subscription_pair.hpp"

#include <utility>

#include "bounded_reading.hpp"
#include "image_message.hpp"
#include "subscribing_lock.hpp"

namespace robot_vision
{

SubscriptionPair::SubscriptionPair(const ros::NodeHandle& nh, Params params)
  : nh_(nh),
    topic_(nh.resolveName(params.name)),
    params_(std::move(params)),
    is_tracked_(params_.tracked_object),
    tracked_object_(params_.tracked_object)
{
  params_.tracked_object.reset();  // it may own this
}

SubscriptionPair::~SubscriptionPair()
{
  for (const Way way : {Way::kRaw, Way::kShared})
    drop(way);
}

bool SubscriptionPair::openRaw(const Callback<sensor_msgs::Image>& callback)
{
  if (!isWanted(Way::kRaw)) return false;
  // By the name, as what was remapped already would be remapped again: where left and right are exchanged, say.
  return open(Way::kRaw, boundedOptions<sensor_msgs::Image>(params_.name, params_.queue_size, callback,
                                                            [pool = ImagePool()] { return pool.take(); }));
}

bool SubscriptionPair::openShared(const Callback<ShmImage>& callback)
{
  if (!isWanted(Way::kShared)) return false;
  return open(Way::kShared, boundedOptions<ShmImage>(sharedTopic(), params_.queue_size, callback));
}

bool SubscriptionPair::open(Way way, ros::SubscribeOptions options)
{
  const ros::VoidPtr tracked = tracked_object_.lock();
  if (is_tracked_ && !tracked) return false;
  options.transport_hints = params_.hints;
  options.tracked_object = tracked;
  const SubscribingLock subscribing;
  keep(way, nh_.subscribe(options));
  return true;
}

bool SubscriptionPair::isWanted(Way way) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return !closed_ && !member(way);
}

void SubscriptionPair::keep(Way way, ros::Subscriber subscriber)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!closed_) std::swap(member(way), subscriber);
}

bool SubscriptionPair::drop(Way way)
{
  ros::Subscriber dropped;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::swap(dropped, member(way));
  }
  const bool was_open = dropped;
  if (was_open) endSubscription(dropped);  // else a review, which mostly drops nothing, would wait for the lock
  return was_open;
}

void SubscriptionPair::close()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  closed_ = true;
}

std::uint32_t SubscriptionPair::publishers(Way way) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return member(way) ? member(way).getNumPublishers() : 0;
}

}  // namespace robot_vision
