#pragma once

#include <image_transport/image_transport.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "callback_gate.hpp"
#include "latest_image_subscriber.hpp"
#include "pooled_image_publisher.hpp"
#include "waker.hpp"

namespace robot_vision
{

/// The images of one of the nodes of another client library in this process. A thread of the caller works through them
/// with next(), so that a node whose thread is slow delays no other. Thread-safe.
class NodeQueue
{
public:
  /// What the queue has of its process.
  struct Process
  {
    std::shared_ptr<ProcessSubscriptions> subscriptions;
    std::function<std::shared_ptr<image_transport::ImageTransport>()> transports;  // throws once the process ends
    CallbackGate::Between between;                                                 // of the gate to the queue of these
  };

  /// `node`: the name of the node; `diagnostics_topic`: where its statistics go to.
  NodeQueue(Process process, std::string node, std::string diagnostics_topic);
  ~NodeQueue() { close(); }
  NodeQueue(const NodeQueue&) = delete;
  NodeQueue& operator=(const NodeQueue&) = delete;

  /// The following three throw std::runtime_error once the queue is closed. This one throws std::invalid_argument if
  /// the encoding is unknown, or if the transport is not installed, naming the installed ones.
  std::shared_ptr<LatestImageSubscriber> makeInbox(const LatestImageSubscriber::Params& params,
                                                   std::shared_ptr<FrameStatistics> statistics);
  std::shared_ptr<PooledImagePublisher> makeOutbox(const std::string& topic);
  /// Makes statistics that are published under the name of the node, with its ~diagnostic_period.
  std::shared_ptr<FrameStatistics> makeStatistics();

  struct Delivery
  {
    std::shared_ptr<LatestImageSubscriber> inbox;
    ReceivedImage image;
  };

  /// Takes the newest image of a subscriber, in turn if several have one. Waits at most `timeout_s`. The result is
  /// empty if no image came, if connections have changed, if it was interrupted, or if the queue is closed. To be
  /// called by one thread only.
  std::optional<Delivery> next(double timeout_s);
  /// Has next() return as soon as there is no image to take, for other work of its thread.
  void interrupt();
  /// False once the queue is closed, by close(), with its process, or by a shutdown request (rosnode kill).
  bool running() const { return !closed_ && !ros::isShuttingDown(); }
  /// Acts as if subscribers had come or gone and wakes the thread in next(); for topics of the other client library.
  void noteConnections();
  /// True if subscribers have come or gone since the last call.
  bool connectionsChanged() { return connections_->changed.exchange(false); }
  /// Closes all subscribers and publishers, and ends the statistics. The objects stay valid but do nothing any more.
  void close();

private:
  struct Wake
  {
    std::shared_ptr<Waker> waker;
    void operator()() const { waker->wake(); }
  };

  /// What callbacks of connections need, which may outlive the queue.
  struct Connections
  {
    std::shared_ptr<Waker> waker;
    std::atomic<bool> changed{false};

    void note()
    {
      changed = true;
      waker->wake();
    }
  };

  template <class T>
  void add(std::vector<std::weak_ptr<T>>& all, const std::shared_ptr<T>& one);
  void requireRunning() const;
  std::uint64_t unshared();
  std::optional<Delivery> takeNext();

  const Process process_;
  const std::string node_;
  const std::string diagnostics_topic_;
  std::atomic<bool> closed_{false};
  std::atomic<bool> interrupted_{false};
  std::shared_ptr<Waker> waker_ = std::make_shared<Waker>();
  std::shared_ptr<Connections> connections_ = std::make_shared<Connections>();
  WakingQueue<Wake> queue_;  // of camera_info
  CallbackGate gate_;        // to queue_
  ros::NodeHandle nh_;
  std::size_t turn_ = 0;  // index of the subscriber that was asked last; of the thread in next()

  std::mutex mutex_;  // guards all below; it is never held during calls of the master
  std::vector<std::weak_ptr<LatestImageSubscriber>> subscribers_;
  std::vector<std::weak_ptr<PooledImagePublisher>> publishers_;
  std::vector<std::weak_ptr<SharedTopic>> shared_topics_;  // on which these publish
  std::vector<std::unique_ptr<FrameDiagnostics>> diagnostics_;
};

}  // namespace robot_vision
