#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <std_msgs/Header.h>

#include <boost/shared_ptr.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "advertising_lock.hpp"
#include "image_message.hpp"

namespace robot_vision
{

/// The topics of a node's results. Their names are relative to the node's own: "processed_image", "steps/canny". What
/// is worth the time only if somebody subscribes is made after isWanted() was asked. Thread-safe, except that the
/// images of one topic must be published one after the other.
class LazyOutputs
{
public:
  /// `on_change` is called through the queue of `pnh` when subscribers come or go.
  LazyOutputs(const ros::NodeHandle& pnh, std::function<void()> on_change);

  /// Adds a topic of images, over all installed transports. Does nothing if it is there already.
  void advertiseImages(const std::string& name);

  /// Adds a topic of messages of another type.
  template <class Message>
  void advertise(const std::string& name)
  {
    const auto on_connection = [this](const ros::SingleSubscriberPublisher&) { on_change_(); };
    const AdvertisingLock advertising;
    const auto publisher =
        std::make_shared<ros::Publisher>(pnh_.advertise<Message>(name, kQueueSize, on_connection, on_connection));
    add(name, {[publisher] { return publisher->getNumSubscribers() > 0; }, publisher, nullptr});
  }

  /// Removes a topic, which must not be published on any more.
  void withdraw(const std::string& name);

  /// Whether somebody subscribes to any topic, or to that of this name.
  bool areWanted() const;
  bool isWanted(const std::string& name) const;

  /// What is shared of a topic of images, for an ImagePool.
  std::shared_ptr<SharedTopic> shared(const std::string& name) const { return output(name).images->shared; }

  /// The frames of all topics that were not published over shm for want of memory.
  std::uint64_t unshared() const;

  /// Publishes the image that `fill` writes (see ImageMaker) with this header, but for the number: images are numbered
  /// here, as roscpp does so only for those of other processes.
  void publishImage(const std::string& name, const std_msgs::Header& header, const ImageMaker::Fill& fill);

  /// Numbers and publishes an image, which must not change afterwards: subscribers in the process share it.
  void publishImage(const std::string& name, const sensor_msgs::ImagePtr& message);

  /// Publishes a message, which must not change afterwards: subscribers in the process share it.
  template <class Message>
  void publish(const std::string& name, const boost::shared_ptr<Message>& message)
  {
    output(name).messages->publish(message);
  }

private:
  static constexpr std::uint32_t kQueueSize = 1;

  struct ImageTopic
  {
    image_transport::Publisher publisher;
    std::shared_ptr<SharedTopic> shared;
    ImageMaker maker;
    std::uint32_t published = 0;  // number of images
  };

  struct Output
  {
    std::function<bool()> is_wanted;
    std::shared_ptr<ros::Publisher> messages;  // null for images
    std::shared_ptr<ImageTopic> images;        // null for other messages
  };

  static void publish(ImageTopic& images, const sensor_msgs::ImagePtr& message);
  void add(const std::string& name, Output output);
  Output output(const std::string& name) const;

  ros::NodeHandle pnh_;
  image_transport::ImageTransport it_;
  std::function<void()> on_change_;
  mutable std::mutex mutex_;  // guards outputs_: subscribers come also while topics are added
  std::map<std::string, Output> outputs_;
};

}  // namespace robot_vision
