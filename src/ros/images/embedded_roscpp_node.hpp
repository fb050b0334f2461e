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

/// The roscpp half of a process that is a node of another client library: a second node, with a queue for pictures that
/// a thread of the caller works through, and a thread of its own for all else. Both sleep while there is nothing to do.
/// One per process.
class EmbeddedRoscppNode
{
public:
  /// Starts the node `name` (absolute). `options` are roscpp's special names (__ip, __hostname, ...) and their values.
  /// `node`, at `node_uri`, is that of the other client library.
  EmbeddedRoscppNode(const std::string& name, const ros::M_string& options, const std::string& node,
                     const std::string& node_uri);
  ~EmbeddedRoscppNode() { stop(); }
  EmbeddedRoscppNode(const EmbeddedRoscppNode&) = delete;
  EmbeddedRoscppNode& operator=(const EmbeddedRoscppNode&) = delete;

  std::shared_ptr<LatestImageSubscriber> makeInbox(const LatestImageSubscriber::Params& params,
                                                   std::shared_ptr<FrameStatistics> statistics);
  std::shared_ptr<PooledImagePublisher> makeOutbox(const std::string& topic);
  /// Statistics that are published on /diagnostics under the name of `node`, by its ~diagnostic_period.
  std::shared_ptr<FrameDiagnostics> makeDiagnostics(const std::string& node);

  struct Delivery
  {
    std::shared_ptr<LatestImageSubscriber> inbox;
    ReceivedImage picture;
  };

  /// Calls what waits in the queue, and takes the newest picture of an inbox: of each in turn, if several have one.
  /// Waits at most `timeout_s` for it. Nothing if none came, if connections have changed, and when the node has ended.
  std::optional<Delivery> next(double timeout_s);
  /// False when the node has ended: by stop(), or because somebody has shut it down (rosnode kill).
  bool running() const { return !stopped_ && !ros::isShuttingDown(); }
  /// As if subscribers had come or gone; wakes the thread in next(). For topics of the other client library.
  void noteConnections();
  /// Whether subscribers have come or gone since the last call.
  bool connectionsChanged() { return connections_changed_.exchange(false); }
  /// Closes all that was made and ends the node; inboxes and outboxes stay valid, and do nothing more.
  void stop();

private:
  std::atomic<bool> stopped_{false};
  std::atomic<bool> connections_changed_{false};
  ros::CallbackQueue queue_;
  CallbackGate gate_;  // to it
  std::shared_ptr<ros::NodeHandle> nh_;
  std::thread others_;  // works through roscpp's own queue

  template <class T>
  std::shared_ptr<T> add(std::vector<std::weak_ptr<T>>& all, std::shared_ptr<T> one);
  std::shared_ptr<image_transport::ImageTransport> transport();
  void requireRunning() const;
  std::optional<Delivery> takeNext();

  std::mutex mutex_;  // guards all below, and is never held while the master is asked
  std::shared_ptr<Registration> registration_;
  std::shared_ptr<image_transport::ImageTransport> it_;
  std::vector<std::weak_ptr<LatestImageSubscriber>> inboxes_;
  std::size_t turn_ = 0;  // of the inbox that is asked first
  std::vector<std::weak_ptr<PooledImagePublisher>> outboxes_;
  std::vector<std::shared_ptr<FrameDiagnostics>> diagnostics_;
};

}  // namespace robot_vision
