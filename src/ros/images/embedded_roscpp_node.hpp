#pragma once

#include <image_transport/image_transport.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "callback_gate.hpp"
#include "latest_image_subscriber.hpp"
#include "pooled_image_publisher.hpp"
#include "registration.hpp"

namespace robot_vision
{

/// A roscpp node inside a process that already is a node of another client library. Images have a queue that a thread
/// of the caller works through with next(); a thread of this object serves all else. Both sleep while there is nothing
/// to do. There may be one per process.
class EmbeddedRoscppNode
{
public:
  /// Starts the node `name` (absolute). `options` are roscpp's special names (__ip, __hostname, ...) and their values.
  /// `node` and `node_uri` are the name and the URI of the other client library's node.
  EmbeddedRoscppNode(const std::string& name, const ros::M_string& options, const std::string& node,
                     const std::string& node_uri);
  ~EmbeddedRoscppNode() { stop(); }
  EmbeddedRoscppNode(const EmbeddedRoscppNode&) = delete;
  EmbeddedRoscppNode& operator=(const EmbeddedRoscppNode&) = delete;

  std::shared_ptr<LatestImageSubscriber> makeInbox(const LatestImageSubscriber::Params& params,
                                                   std::shared_ptr<FrameStatistics> statistics);
  std::shared_ptr<PooledImagePublisher> makeOutbox(const std::string& topic);
  /// Makes statistics that are published on /diagnostics under the name of `node`, with its ~diagnostic_period.
  std::shared_ptr<FrameDiagnostics> makeDiagnostics(const std::string& node);

  struct Delivery
  {
    std::shared_ptr<LatestImageSubscriber> inbox;
    ReceivedImage image;
  };

  /// Runs the callbacks in the queue and takes the newest image of a subscriber, in turn if several have one. Waits at
  /// most `timeout_s`. The result is empty if no image came, if connections have changed, or if the node has ended.
  std::optional<Delivery> next(double timeout_s);
  /// False when the node has ended, by stop() or by a shutdown request (rosnode kill).
  bool running() const { return !stopped_ && !ros::isShuttingDown(); }
  /// Acts as if subscribers had come or gone and wakes the thread in next(); for topics of the other client library.
  void noteConnections();
  /// True if subscribers have come or gone since the last call.
  bool connectionsChanged() { return connections_changed_.exchange(false); }
  /// Closes all subscribers and publishers and ends the node. The objects stay valid but do nothing any more.
  void stop();

private:
  std::atomic<bool> stopped_{false};
  std::atomic<bool> connections_changed_{false};
  ros::CallbackQueue queue_;
  CallbackGate gate_;  // to queue_
  std::shared_ptr<ros::NodeHandle> nh_;
  std::thread global_spinner_;  // works through roscpp's global queue

  template <class T>
  std::shared_ptr<T> add(std::vector<std::weak_ptr<T>>& all, std::shared_ptr<T> one);
  template <class T>
  std::shared_ptr<T> held(const std::shared_ptr<T>& member);
  void requireRunning() const;
  std::optional<Delivery> takeNext();

  std::mutex mutex_;  // guards all below; it is never held during calls of the master
  std::shared_ptr<Registration> registration_;
  std::shared_ptr<image_transport::ImageTransport> it_;
  std::vector<std::weak_ptr<LatestImageSubscriber>> subscribers_;
  std::size_t turn_ = 0;  // index of the subscriber that was asked last
  std::vector<std::weak_ptr<PooledImagePublisher>> publishers_;
  std::vector<std::shared_ptr<FrameDiagnostics>> diagnostics_;
};

}  // namespace robot_vision
