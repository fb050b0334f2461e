#pragma once

#include <image_transport/subscriber_plugin.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "robot_vision/common/throttle.hpp"
#include "ros/images/bounded_reading.hpp"
#include "ros/images/image_message.hpp"
#include "waiting_messages.hpp"

namespace robot_vision
{

/// A subscriber plugin that refuses messages that it cannot decode with a throttled error. Unlike
/// image_transport::SimpleSubscriberPlugin it takes no more memory for a message than the message has bytes.
template <class Message>
class TransportSubscriber : public image_transport::SubscriberPlugin
{
public:
  std::string getTopic() const override { return subscriber_.getTopic(); }
  std::uint32_t getNumPublishers() const override { return subscriber_.getNumPublishers(); }
  void shutdown() override { subscriber_.shutdown(); }

protected:
  /// `more_messages` is how many further messages may be needed for one image. An image is given when fewer messages
  /// wait behind it than the queue is to hold, and in place of one that has waited for too long.
  explicit TransportSubscriber(std::uint32_t more_messages = 0) : more_messages_(more_messages) {}

  /// The image of a message, null if it has none. Throws for a message that cannot be used.
  virtual sensor_msgs::ImagePtr decode(const Message& message) = 0;

  /// The message of an image that `fill` writes, see ImageMaker.
  sensor_msgs::ImagePtr makeImage(const std_msgs::Header& header, const ImageMaker::Fill& fill)
  {
    const sensor_msgs::ImagePtr image = maker_.make(fill);
    image->header = header;
    return image;
  }

  /// The number of messages that wait behind the one that is decoded.
  std::int64_t waiting() const { return waiting_->count(); }

  /// The namespace of the transport's parameters.
  const ros::NodeHandle& nh() const { return *nh_; }

private:
  void subscribeImpl(ros::NodeHandle& nh, const std::string& base_topic, std::uint32_t queue_size,
                     const Callback& callback, const ros::VoidPtr& tracked_object,
                     const image_transport::TransportHints& hints) override
  {
    nh_ = std::make_unique<ros::NodeHandle>(hints.getParameterNH(), getTransportName());
    queue_size_ = std::max(queue_size, 1U);
    waiting_ = std::make_unique<WaitingMessages>(*nh.getCallbackQueue());
    ros::SubscribeOptions options = boundedOptions<Message>(
        base_topic + "/" + getTransportName(), queue_size + more_messages_,
        [this, callback](const boost::shared_ptr<const Message>& message) { onMessage(*message, callback); });
    options.callback_queue = waiting_.get();
    options.tracked_object = tracked_object;
    options.transport_hints = hints.getRosHints();
    subscriber_ = nh.subscribe(options);
  }

  void onMessage(const Message& message, const Callback& callback)
  {
    try
    {
      if (sensor_msgs::ImagePtr image = decode(message))
      {
        if (!newest_) kept_since_ = Clock::now();
        newest_ = std::move(image);
      }
    }
    catch (const std::exception& e)
    {
      if (refused_.due()) ROS_ERROR("refused a frame on %s: %s", getTopic().c_str(), e.what());
    }
    // A sender that is faster than decode() is must not keep all images away.
    const bool is_due = more_messages_ == 0 || Clock::now() - kept_since_ > kMaxWait;
    if (newest_ && (waiting() < queue_size_ || is_due)) callback(std::exchange(newest_, nullptr));
  }

  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kMaxWait{100};

  std::uint32_t more_messages_;
  std::uint32_t queue_size_ = 1;
  sensor_msgs::ImagePtr newest_;  // that is not given as long as enough messages wait
  Clock::time_point kept_since_;  // when the first one was not
  std::unique_ptr<WaitingMessages> waiting_;
  std::unique_ptr<ros::NodeHandle> nh_;
  ImageMaker maker_;
  Throttle refused_;
  ros::Subscriber subscriber_;
};

}  // namespace robot_vision
