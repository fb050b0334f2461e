#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "callback_gate.hpp"
#include "node_queue.hpp"
#include "nodelet_host.hpp"
#include "process_images.hpp"
#include "registration.hpp"

namespace robot_vision
{

/// A roscpp node inside a process that already is a node, or several, of another client library: each has a queue for
/// its images, and nodelets can be loaded beside them, whose images come to the queues without a copy. A thread of this
/// object serves all that is neither. There may be one per process.
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

  /// Makes the queue of a node of the process, which must not outlive this object. Throws std::runtime_error after
  /// stop().
  std::shared_ptr<NodeQueue> makeQueue(const std::string& node, const std::string& diagnostics_topic);
  /// The nodelets of this process, which begin with the first call. ~num_worker_threads is that of the other client
  /// library's node, as of a nodelet manager. Throws std::runtime_error after stop(), std::invalid_argument for a bad
  /// parameter.
  std::shared_ptr<NodeletHost> nodelets();
  /// To be called after services were advertised in this process; see Registration.
  void noteServices();
  /// False when the node has ended, by stop() or by a shutdown request (rosnode kill).
  bool running() const { return !stopped_ && !ros::isShuttingDown(); }
  /// Unloads the nodelets, closes all queues and ends the node. The objects stay valid but do nothing any more.
  void stop();

private:
  std::atomic<bool> stopped_{false};
  const std::string node_;
  CallbackGate gate_;  // to roscpp's global queue
  std::shared_ptr<ros::NodeHandle> nh_;
  std::thread global_spinner_;  // works through roscpp's global queue
  std::shared_ptr<ProcessSubscriptions> subscriptions_ = std::make_shared<ProcessSubscriptions>();

  template <class T>
  std::shared_ptr<T> held(const std::shared_ptr<T>& member);
  void requireRunning() const;

  std::mutex mutex_;  // guards all below; it is never held during calls of the master
  std::shared_ptr<Registration> registration_;
  std::shared_ptr<image_transport::ImageTransport> it_;
  std::vector<std::weak_ptr<NodeQueue>> queues_;
  std::shared_ptr<NodeletHost> nodelets_;
};

}  // namespace robot_vision
