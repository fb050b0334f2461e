#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "callback_gate.hpp"
#include "image_subscription.hpp"
#include "process_frame.hpp"
#include "waker.hpp"

namespace robot_vision
{

/// The images of a topic over one image_transport, received once for all nodes of the process. What has come waits
/// until one of the listeners has time: its thread reads or decodes the message, for all of them. Thread-safe.
class ProcessImages
{
public:
  /// Somebody who takes images. Both functions may be called by any thread, and return at once.
  class Listener
  {
  public:
    virtual ~Listener() = default;
    virtual void onComing() = 0;  // something has come: receive() it
    virtual void onFrame(const std::shared_ptr<ProcessFrame>& frame) = 0;
  };

  /// `topic` is absolute, and not remapped any more.
  ProcessImages(std::string topic, std::string transport);
  ~ProcessImages() { close(); }
  ProcessImages(const ProcessImages&) = delete;
  ProcessImages& operator=(const ProcessImages&) = delete;

  /// Gives a listener the frames from now on, and what publishers keep for those who come late (latched topics).
  /// Subscribes if nobody has done so; `parameters` is the namespace of the transport's own parameters. If the master
  /// does not answer, it waits until roscpp is shut down.
  void add(Listener& listener, const std::string& parameters);
  void remove(Listener& listener);  // when it returns, no function of the listener is called any more
  /// Gives all listeners what has come.
  void receive();
  std::uint32_t publishers() const;
  /// Unsubscribes for good, and waits for a running receive().
  void close();

private:
  struct Wake
  {
    ProcessImages* images;
    void operator()() const { images->onComing(); }
  };

  /// A subscription for one listener who has missed frames, until the next one that comes for all: roscpp gives what is
  /// latched to each subscription once.
  struct Late
  {
    Listener* listener;
    bool over = false;
    ImageSubscription subscription;
  };
  using Transports = std::shared_ptr<image_transport::ImageTransport>;

  void subscribe(const std::string& parameters);
  void catchUp(Listener& listener, const std::string& parameters);
  ImageSubscription subscription(image_transport::ImageTransport& it, const std::string& parameters,
                                 const ImageSubscription::Callback& callback);
  void endLate(const std::function<bool(const Late&)>& ends);
  void onComing();
  void onImage(const sensor_msgs::ImageConstPtr& message);
  void onMissedImage(const Late& late, const sensor_msgs::ImageConstPtr& message);

  const std::string topic_;
  const std::string transport_;
  const ImagePool pool_;  // for what is converted
  WakingQueue<Wake> queue_;
  CallbackGate gate_;  // to queue_
  ros::NodeHandle nh_;

  std::mutex receiving_;    // held while messages are read or decoded
  std::mutex subscribing_;  // held while the master is asked

  std::mutex listeners_mutex_;  // guards the next three
  std::vector<Listener*> listeners_;
  std::vector<std::shared_ptr<Late>> late_;
  bool has_come_ = false;  // a frame, so that listeners who are added have missed it

  mutable std::mutex mutex_;  // guards all below
  bool closed_ = false;
  bool subscribed_ = false;
  Transports it_;  // has the queue
  ImageSubscription subscription_;
};

/// The ProcessImages of a process. Thread-safe.
class ProcessSubscriptions
{
public:
  /// What everybody gets who asks for the same; null after close().
  std::shared_ptr<ProcessImages> take(const std::string& topic, const std::string& transport);
  /// Closes all of them.
  void close();

private:
  std::mutex mutex_;  // guards all below
  bool closed_ = false;
  std::map<std::pair<std::string, std::string>, std::weak_ptr<ProcessImages>> images_;  // by topic and transport
};

}  // namespace robot_vision
